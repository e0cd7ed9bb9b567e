; Traps: what to do where reflexes alone would stay (the fly at the window).
; Reads  trap, mode, goal, looked-from, clock      Sets  mode, goal
; The first time the robot wanders out; the second time it goes back to where it has looked around, an intermediate target from
; which another way may be open; then the target is left alone. (Bou-Ghannam 1992, sections 3.4, 4.1 and 6.2.)

(defglobal ?*escape-s* = 8.0) ; a random heading held for so long leads a few metres away

(deffacts ways-out
  (uses escape random_wander)
  (uses detour path_following))

(defrule trapped-wander-out "No progress on the way to a target: wander out of it"
  (declare (salience ?*trapped*))
  ?mode <- (mode go)
  (trap (trap no-progress))
  ?goal <- (goal (target ?target))
  (not (trapped ?target))
  =>
  (retract ?mode ?goal)
  (assert (mode escape) (escape-since (now)) (trapped ?target)))

(defrule escaped-choose "It is out, or has tried for long enough"
  ?mode <- (mode escape)
  ?since <- (escape-since ?start)
  (clock (time-s ?now&:(> (- ?now ?start) ?*escape-s*)))
  =>
  (retract ?mode ?since)
  (assert (mode choose)))

(defrule trapped-again-intermediate-target "Trapped on the way to the same target: go back to where it last looked around"
  (declare (salience ?*trapped*))
  ?mode <- (mode go)
  (trap (trap no-progress))
  ?goal <- (goal (target ?target))
  ?trapped <- (trapped ?target)
  (looked-from ?x ?y)
  =>
  (retract ?mode ?goal ?trapped)
  (assert (mode detour) (failed ?target (now)) (goal (target nil) (x-m ?x) (y-m ?y) (length-m 0.0) (since-s (now)))))

(defrule detour-over-choose "The intermediate target is reached, or cannot be"
  ?mode <- (mode detour)
  ?goal <- (goal)
  (motivation (id path_following) (number ?asked))
  (behaviour (id path_following) (acknowledged ?asked) (outcome reached|blocked))
  =>
  (retract ?mode ?goal)
  (assert (mode choose)))

(defrule cycling-choose "Wandering in circles shows nothing new: see whether a target is worth a visit"
  ?mode <- (mode wander)
  (trap (trap cycling))
  (or (exists (candidate))
      (not (postponed ? ?))) ; else there is nothing to choose, and it would wander on at once
  =>
  (retract ?mode)
  (assert (mode choose)))
