; Explore: look around, then visit what is worth a visit, the nearest first, and look around there; wander when nothing is near;
; done when wandering brings nothing new.
; Reads  target, travel, behaviour, clock      Sets  mode, goal, the mission's end
; A behaviour's status counts once it acknowledges the newest motivation, by its number.
; (Bou-Ghannam 1992, sections 4.1 and 6.1; `arbitration.clp` turns modes into behaviours and names the saliences, `traps.clp` and `recovery.clp` help out.)

(defglobal ?*first-wander-s* = 90.0) ; along the boundaries, before it looks for targets: once around a room
(defglobal ?*wander-s* = 45.0)       ; how long it wanders before it asks again whether something is worth a visit
(defglobal ?*quiet-spells* = 3)      ; so many spells that bring nothing new, one after the other, and the place is explored
(defglobal ?*look-rad* = 3.15)       ; how far it turns at a target: half a turn shows all to a ring, or to a laser that looks ahead
(defglobal ?*same-place-m* = 0.5)    ; looking again from within this of a place shows nothing new
(defglobal ?*tries* = 3)             ; a target that the robot could not get to so often is given up
(defglobal ?*rest-s* = 30.0)         ; how long it leaves a target alone that it could not get to

(deftemplate candidate "A target that could be visited now, and how far it is"
  (slot target) (slot length-m) (slot x-m) (slot y-m))

(deffacts beginning (mode look-around) (quiet-spells 0) (wander-for ?*first-wander-s*))

(deffunction apart-m (?x1 ?y1 ?x2 ?y2)
  (sqrt (+ (** (- ?x1 ?x2) 2) (** (- ?y1 ?y2) 2))))

; What could be visited

(defrule target-is-reachable "A target with a way to it is a candidate, unless it was given up or has to rest"
  (travel (id ?target) (state reachable) (length-m ?length) (stand-x-m ?x) (stand-y-m ?y))
  (target (id ?target))
  (not (given-up ?target))
  (not (postponed ?target ?))
  =>
  (assert (candidate (target ?target) (length-m ?length) (x-m ?x) (y-m ?y))))

(defrule candidate-target-is-gone "Its travel may stand a little longer than the target"
  (declare (salience ?*tidy*))
  ?candidate <- (candidate (target ?target))
  (not (target (id ?target)))
  =>
  (retract ?candidate))

(defrule candidate-is-outdated "What was known of the way has changed"
  (declare (salience ?*tidy*))
  ?candidate <- (candidate (target ?target) (length-m ?length) (x-m ?x) (y-m ?y))
  (not (travel (id ?target) (state reachable) (length-m ?length) (stand-x-m ?x) (stand-y-m ?y)))
  =>
  (retract ?candidate))

(defrule candidate-is-given-up "It is not visited any more"
  (declare (salience ?*tidy*))
  ?candidate <- (candidate (target ?target))
  (or (given-up ?target) (postponed ?target ?))
  =>
  (retract ?candidate))

(defrule place-was-looked-at "From there the robot has looked around already: once more would show nothing new"
  (declare (salience ?*note*))
  (travel (id ?target) (stand-x-m ?x) (stand-y-m ?y))
  (looked-from ?lx ?ly)
  (test (< (apart-m ?x ?y ?lx ?ly) ?*same-place-m*))
  (not (goal (target ?target)))
  =>
  (assert (given-up ?target)))

; What to do next

(defrule looked-around-choose "The turn on the spot is over"
  ?mode <- (mode look-around)
  (motivation (id curiosity) (number ?asked))
  (behaviour (id curiosity) (acknowledged ?asked) (outcome reached))
  (pose-estimate (map-from-robot-x-m ?x) (map-from-robot-y-m ?y))
  =>
  (retract ?mode)
  (assert (mode choose) (looked-from ?x ?y)))

(defrule seen-enough-choose "What it came for has been seen: no need to turn on"
  (declare (salience ?*gone*))
  ?mode <- (mode look-around)
  (looks-for ?target)
  (not (target (id ?target)))
  =>
  (retract ?mode)
  (assert (mode choose)))

(defrule look-is-over "Forget what it looked for"
  (declare (salience ?*at-once*))
  ?looks <- (looks-for ?)
  (not (mode look-around))
  =>
  (retract ?looks))

(defrule first-wander "Before it looks for targets it gets an overall picture"
  (declare (salience ?*note*))
  ?mode <- (mode choose)
  ?spell <- (wander-for ?s)
  =>
  (retract ?mode ?spell)
  (assert (mode wander) (wander-until (+ (now) ?s))))

(defrule nearest-target-go "Go to the nearest candidate"
  (declare (salience ?*choose*))
  ?mode <- (mode choose)
  (candidate (target ?target) (length-m ?length) (x-m ?x) (y-m ?y))
  (not (candidate (length-m ?other&:(< ?other ?length))))
  ?spells <- (quiet-spells ?)
  =>
  (retract ?mode ?spells)
  (assert (mode go) (goal (target ?target) (x-m ?x) (y-m ?y) (length-m ?length) (since-s (now))) (quiet-spells 0)))

(defrule nothing-near-wander "No candidate: wander for a while, along the boundaries"
  (declare (salience ?*wander*))
  ?mode <- (mode choose)
  ?spells <- (quiet-spells ?n&:(< ?n ?*quiet-spells*))
  =>
  (retract ?mode ?spells)
  (assert (mode wander) (wander-until (+ (now) ?*wander-s*)) (quiet-spells (+ ?n 1))))

(defrule wandered-choose "A spell of wandering is over"
  ?mode <- (mode wander)
  (wander-until ?until)
  (clock (time-s ?now&:(>= ?now ?until)))
  =>
  (retract ?mode)
  (assert (mode choose)))

(defrule wander-is-over "Forget when it was to end"
  (declare (salience ?*at-once*))
  ?until <- (wander-until ?)
  (not (mode wander))
  =>
  (retract ?until))

(defrule nothing-left-done "Wandering brought nothing new, and no target rests: the place is explored"
  (declare (salience ?*end*))
  ?mode <- (mode choose)
  (quiet-spells ?n&:(>= ?n ?*quiet-spells*))
  (not (postponed ? ?))
  =>
  (retract ?mode)
  (assert (mode done))
  (post (mission (state done) (detail "nothing is left that is worth a visit and can be reached"))))

(defrule targets-rest-wander "Only targets that rest are left: wander until they have rested"
  (declare (salience ?*end*))
  ?mode <- (mode choose)
  (quiet-spells ?n&:(>= ?n ?*quiet-spells*))
  (exists (postponed ? ?))
  =>
  (retract ?mode)
  (assert (mode wander) (wander-until (+ (now) ?*wander-s*))))

; On the way

(defrule goal-reached-look-around "Look around at the target"
  (declare (salience ?*reached*))
  ?mode <- (mode go)
  ?goal <- (goal (target ?target) (x-m ?x) (y-m ?y))
  (motivation (id path_following) (number ?asked))
  (behaviour (id path_following) (acknowledged ?asked) (outcome reached))
  =>
  (retract ?mode ?goal)
  (motivate curiosity ?*look-rad*)
  (assert (mode look-around) (looks-for ?target) (looked-from ?x ?y) (given-up ?target)))

(defrule goal-gone-choose "What was to be seen there has been seen on the way"
  (declare (salience ?*gone*))
  ?mode <- (mode go)
  ?goal <- (goal (target ?target))
  (not (target (id ?target)))
  =>
  (retract ?mode ?goal)
  (assert (mode choose)))

(defrule goal-blocked-postpone "The robot does not get there: later, perhaps"
  (declare (salience ?*blocked*))
  ?mode <- (mode go)
  ?goal <- (goal (target ?target))
  (motivation (id path_following) (number ?asked))
  (behaviour (id path_following) (acknowledged ?asked) (outcome blocked))
  =>
  (retract ?mode ?goal)
  (assert (mode choose) (failed ?target (now))))

(defrule failed-often-give-up "It has been tried often enough"
  (declare (salience ?*note*))
  ?failed <- (failed ?target ?)
  ?tried <- (tried ?target ?n&:(>= ?n (- ?*tries* 1)))
  =>
  (retract ?failed ?tried)
  (assert (given-up ?target)))

(defrule failed-rest "Leave it alone for a while"
  ?failed <- (failed ?target ?when)
  (not (tried ?target ?))
  =>
  (retract ?failed)
  (assert (tried ?target 1) (postponed ?target (+ ?when ?*rest-s*))))

(defrule failed-again-rest "Leave it alone for a while, once more"
  ?failed <- (failed ?target ?when)
  ?tried <- (tried ?target ?n&:(< ?n (- ?*tries* 1)))
  =>
  (retract ?failed ?tried)
  (assert (tried ?target (+ ?n 1)) (postponed ?target (+ ?when ?*rest-s*))))

(defrule rested-try-again "A target has rested"
  ?postponed <- (postponed ?target ?until)
  (clock (time-s ?now&:(>= ?now ?until)))
  =>
  (retract ?postponed))
