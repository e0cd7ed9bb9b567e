; Recovery: what to do when time passes without progress, or when something that the plan builds on does not work.
; Reads  goal, clock, behaviour, communication-error, component, mode      Sets  mode, goal, uses, the mission's end
; (Bou-Ghannam 1992, sections 4.2, 5.1 and 6.2.)

(defglobal ?*slowest-mps* = 0.05) ; a way that takes longer than at this speed,
(defglobal ?*patience-s* = 60.0)  ; and so much for someone who stands in it, leads nowhere

(defrule goal-takes-too-long "The way to the goal should long be done"
  (declare (salience ?*late*))
  ?mode <- (mode go)
  ?goal <- (goal (target ?target) (length-m ?length) (since-s ?since))
  (clock (time-s ?now&:(> (- ?now ?since) (+ ?*patience-s* (/ ?length ?*slowest-mps*)))))
  =>
  (retract ?mode ?goal)
  (assert (mode choose) (failed ?target (now))))

(defrule behaviour-is-lost "A behaviour has failed, or does not answer"
  (or (behaviour (id ?behaviour) (state failed))
      (communication-error (id ?behaviour)))
  =>
  (assert (lost ?behaviour)))

(defrule behaviour-is-back "It answers again"
  ?lost <- (lost ?behaviour)
  (behaviour (id ?behaviour) (state ~failed))
  (not (communication-error (id ?behaviour)))
  =>
  (retract ?lost))

(defrule path-following-lost-use-target-nav "Without path-following it goes straight for its targets, and round what is in the way"
  (lost path_following)
  ?uses <- (uses ?mode path_following)
  (not (lost target_nav))
  =>
  (retract ?uses)
  (assert (uses ?mode target_nav)))

(defrule curiosity-lost-go-on "Without curiosity there is no looking around: choose at once"
  (declare (salience ?*note*))
  (lost curiosity)
  ?mode <- (mode look-around)
  =>
  (retract ?mode)
  (assert (mode choose)))

(defrule ways-unknown-give-up "Nobody tells how far targets are: nothing can be chosen"
  (declare (salience ?*tidy*))
  ?mode <- (mode choose)
  (component (id travel) (state failed) (error ?error))
  =>
  (retract ?mode)
  (assert (mode done))
  (post (mission (state given-up) (detail (str-cat "nobody tells how far targets are: " ?error)))))
