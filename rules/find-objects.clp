; Find objects: look where they usually stand, and at whatever looks like one; explore for the rest; done when all are found.
; Reads  looking-for, usually-stands-in, corner, found-object, candidate, mode      Sets  target, mode, goal, the mission's end
; (looking-for OBJECT NUMBER) says what and how many, (usually-stands-in OBJECT corner) is a-priori knowledge: the search needs the
; first only. Stands on `explore.clp`. (Bou-Ghannam 1992, section 4.1: the search for green drums that stand in corners.)

(defglobal ?*into-corner-m* = 0.8)  ; the middle of what is looked at: a drum of 0.3 m radius fills a corner so far
(defglobal ?*stand-off-m* = 1.5)    ; from there a corner is in the camera's view, and near
(defglobal ?*same-corner-m* = 0.8)  ; corners nearer to each other are one: lines move a little
(defglobal ?*much-nearer* = 0.25)    ; what is on the way, at less than so much of the length, is not passed by
(defglobal ?*good-look-m* = 2.2)    ; into a corner from so near, with a way there of no more than
(defglobal ?*way-there-m* = 3.0)    ; so much, that is with no wall between,
(defglobal ?*ahead* = 0.93)         ; and within 21 degrees of straight ahead (the cosine), shows what stands there
(defglobal ?*all-round-rad* = 6.3)  ; a whole turn
(defglobal ?*spell-s* = 20.0)       ; so long it wanders before it looks around, once all is explored
(defglobal ?*search-spells* = 40)   ; and so often, before it gives up

(defglobal              ; saliences beside those of `arbitration.clp`
  ?*suspects-first* = -5
  ?*corners-next* = -6  ; and only then whatever is near
  ?*search-on* = -25    ; nowhere to go, but something is missing
  ?*in-vain* = -26)

(deffacts search (found-count 0) (search-spells 0) (uses search random_wander))

; What is worth a look

(defrule corner-is-worth-a-look "What is looked for usually stands in corners"
  (usually-stands-in ?object corner)
  (looking-for ?object ?)
  (corner (id ?id) (shape concave|unknown) (opening-rad ?opening&:(< 1.0 ?opening 2.1)) (bisector-rad ?bisector)
          (place-x-m ?x) (place-y-m ?y))
  (not (and (corner-noted ?nx ?ny) (test (< (apart-m ?x ?y ?nx ?ny) ?*same-corner-m*))))
  =>
  (assert (corner-noted ?x ?y))
  (post (target (id (sym-cat corner- ?id)) (reason corner) (size-m ?*into-corner-m*)
    (place-x-m (+ ?x (* ?*into-corner-m* (cos ?bisector)))) (place-y-m (+ ?y (* ?*into-corner-m* (sin ?bisector))))
    (stand-x-m (+ ?x (* ?*stand-off-m* (cos ?bisector)))) (stand-y-m (+ ?y (* ?*stand-off-m* (sin ?bisector)))))))

(defrule suspect-is-worth-a-look "What looks like one has to be seen from near by"
  (looking-for ?object ?)
  (found-object (id ?id) (object ?object) (standing suspected) (place-x-m ?x) (place-y-m ?y))
  (not (suspect-noted ?id))
  (pose-estimate (map-from-robot-x-m ?rx) (map-from-robot-y-m ?ry))
  =>
  (bind ?away (max 0.01 (apart-m ?x ?y ?rx ?ry)))
  (bind ?ux (/ (- ?rx ?x) ?away))
  (bind ?uy (/ (- ?ry ?y) ?away))
  (assert (suspect-noted ?id))
  (post (target (id (sym-cat suspect- ?id)) (reason object) (size-m ?*into-corner-m*)
    (place-x-m (+ ?x (* ?*into-corner-m* ?ux))) (place-y-m (+ ?y (* ?*into-corner-m* ?uy)))
    (stand-x-m (+ ?x (* ?*stand-off-m* ?ux))) (stand-y-m (+ ?y (* ?*stand-off-m* ?uy))))))

(defrule corner-is-taken "One was found there already: nothing else fits into that corner"
  (declare (salience ?*note*))
  (found-object (standing confirmed) (place-x-m ?x) (place-y-m ?y))
  (target (id ?target) (reason corner) (place-x-m ?tx) (place-y-m ?ty))
  (test (< (apart-m ?x ?y ?tx ?ty) ?*same-corner-m*))
  (not (goal (target ?target)))
  =>
  (assert (given-up ?target)))

(defrule corner-is-seen "The camera has had a good look into it"
  (declare (salience ?*note*))
  ?seen <- (target (id ?target) (reason corner) (place-x-m ?x) (place-y-m ?y))
  (travel (id ?target) (state reachable) (length-m ?way&:(< ?way ?*way-there-m*)))
  (pose-estimate (map-from-robot-x-m ?rx) (map-from-robot-y-m ?ry) (map-from-robot-heading-rad ?heading))
  (test (< (apart-m ?x ?y ?rx ?ry) ?*good-look-m*))
  (test (> (+ (* (cos ?heading) (- ?x ?rx)) (* (sin ?heading) (- ?y ?ry))) (* ?*ahead* (apart-m ?x ?y ?rx ?ry))))
  =>
  (assert (given-up ?target))
  (retract-entry ?seen))

(defrule suspect-is-settled "It is one, or was none"
  (declare (salience ?*note*))
  (suspect-noted ?id)
  (not (found-object (id ?id) (standing suspected)))
  ?target <- (target (id =(sym-cat suspect- ?id)))
  =>
  (retract-entry ?target))

(defrule looked-there-target-is-over "A place that was looked at is no target any more"
  (declare (salience ?*note*))
  (given-up ?id)
  (not (looks-for ?id)) ; without it the look around it would be over at once
  ?target <- (target (id ?id) (reason corner|object))
  =>
  (retract-entry ?target))

(defrule could-be-anywhere-look-all-round "A camera sees only what is ahead of it: who does not know where to look turns once around"
  (declare (salience ?*urgent*))
  (mode look-around)
  (looking-for ?object ?)
  (or (not (usually-stands-in ?object corner))
      (search-spells ?n&:(> ?n 0))) ; corners alone did not do
  =>
  (motivate curiosity ?*all-round-rad*))

; What to do next

(defrule suspect-first-go "What looks like one comes first, the nearest of them, unless something else lies much nearer"
  (declare (salience ?*suspects-first*))
  ?mode <- (mode choose)
  (candidate (target ?target) (length-m ?length) (x-m ?x) (y-m ?y))
  (target (id ?target) (reason object))
  (not (and (candidate (target ?other) (length-m ?shorter&:(< ?shorter ?length))) (target (id ?other) (reason object))))
  (not (candidate (length-m ?near&:(< ?near (* ?*much-nearer* ?length)))))
  ?spells <- (quiet-spells ?)
  =>
  (retract ?mode ?spells)
  (assert (mode go) (goal (target ?target) (x-m ?x) (y-m ?y) (length-m ?length) (since-s (now))) (quiet-spells 0)))

(defrule corner-first-go "Then where it usually stands, likewise"
  (declare (salience ?*corners-next*))
  ?mode <- (mode choose)
  (candidate (target ?target) (length-m ?length) (x-m ?x) (y-m ?y))
  (target (id ?target) (reason corner))
  (not (and (candidate (target ?other) (length-m ?shorter&:(< ?shorter ?length))) (target (id ?other) (reason corner))))
  (not (candidate (length-m ?near&:(< ?near (* ?*much-nearer* ?length)))))
  ?spells <- (quiet-spells ?)
  =>
  (retract ?mode ?spells)
  (assert (mode go) (goal (target ?target) (x-m ?x) (y-m ?y) (length-m ?length) (since-s (now))) (quiet-spells 0)))

(defrule somewhere-to-look-stop-wandering "There is something to look at: no need to wander"
  (declare (salience ?*note*))
  ?mode <- (mode search)
  (candidate (target ?target))
  (target (id ?target) (reason corner|object))
  =>
  (retract ?mode)
  (assert (mode choose)))

; The end

(defrule found-one-count "One more"
  (declare (salience ?*note*))
  (looking-for ?object ?)
  (found-object (id ?id) (object ?object) (standing confirmed))
  (not (counted ?id))
  ?count <- (found-count ?n)
  =>
  (retract ?count)
  (assert (counted ?id) (found-count (+ ?n 1))))

(defrule lost-one-count "One less: it was another one's"
  (declare (salience ?*tidy*))
  ?counted <- (counted ?id)
  (not (found-object (id ?id) (standing confirmed)))
  ?count <- (found-count ?n)
  =>
  (retract ?counted ?count)
  (assert (found-count (- ?n 1))))

(defrule all-found-done "All are found"
  (declare (salience ?*urgent*))
  (looking-for ?object ?all)
  (found-count ?n&:(>= ?n ?all))
  ?mode <- (mode ~done)
  =>
  (retract ?mode)
  (assert (mode done))
  (post (mission (state done) (detail (str-cat "all " ?all " found: " ?object)))))

(defrule explored-search-on "All is explored, some are missing: wander somewhere, and look around there"
  (declare (salience ?*search-on*))
  ?mode <- (mode choose)
  (quiet-spells ?quiet&:(>= ?quiet 1))
  (looking-for ? ?)
  ?spells <- (search-spells ?n&:(< ?n ?*search-spells*))
  =>
  (retract ?mode ?spells)
  (assert (mode search) (search-until (+ (now) ?*spell-s*)) (search-spells (+ ?n 1))))

(defrule search-looks-again "What has been looked at on the way may have shown only a part: it counts as not looked at, once"
  (declare (salience ?*note*))
  (mode search)
  (search-spells 1)
  ?looked <- (looked-from ? ?)
  =>
  (retract ?looked))

(defrule search-visits-again "And its targets are worth another visit"
  (declare (salience ?*note*))
  (mode search)
  (search-spells 1)
  (target (id ?target) (reason frontier|line-end))
  ?over <- (given-up ?target)
  =>
  (retract ?over))

(defrule searched-look-around "After a spell of searching it looks around"
  ?mode <- (mode search)
  ?spell <- (search-until ?until)
  (clock (time-s ?now&:(>= ?now ?until)))
  =>
  (retract ?mode ?spell)
  (assert (mode look-around)))

(defrule search-is-over "Forget when it was to end"
  (declare (salience ?*at-once*))
  ?spell <- (search-until ?)
  (not (mode search))
  =>
  (retract ?spell))

(defrule searched-in-vain-give-up "It has searched for long enough"
  (declare (salience ?*in-vain*))
  ?mode <- (mode choose)
  (quiet-spells ?quiet&:(>= ?quiet 1))
  (looking-for ?object ?all)
  (found-count ?n)
  =>
  (retract ?mode)
  (assert (mode done))
  (post (mission (state given-up) (detail (str-cat ?n " of " ?all " found: " ?object)))))
