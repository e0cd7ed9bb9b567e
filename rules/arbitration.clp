; Arbitration: which behaviours the robot's mode asks for. avoid_obstacles is a reflex and always on.
; Reads  mode, uses, goal, behaviour, motivation, switch
; Sets   the selection of every behaviour named in a `uses` fact, and how much avoid_obstacles counts
; (Bou-Ghannam 1992, section 4.3: target-nav, boundary-following and random-wander exclude each other.)

; Saliences, by what they are for, the first to fire first
(defglobal
  ?*urgent* = 60    ; whatever else goes on
  ?*at-once* = 50   ; behaviours follow the mode before anything else is decided
  ?*tidy* = 20      ; what does not hold any more goes before something is decided on it
  ?*reached* = 15   ; on the way: it is there,
  ?*gone* = 14      ; or what it goes for is gone,
  ?*blocked* = 13   ; or it does not get there,
  ?*late* = 12      ; or has taken too long,
  ?*trapped* = 11   ; or is in a trap
  ?*note* = 10      ; what follows from facts, without deciding anything
  ?*choose* = -10   ; where to go, once all is known
  ?*wander* = -20   ; nowhere to go
  ?*end* = -30)     ; and nothing else to be done

(defglobal ?*close* = 1.0) ; avoid_obstacles answers with this where one echo lies at its balance distance from the rim

(deftemplate goal "Where the robot is going, and for which target"
  (slot target) (slot x-m) (slot y-m) (slot length-m) (slot since-s))

(deffacts arbitration "(uses MODE BEHAVIOUR): a mode with two behaviours leaves it to the mission file which inhibits which"
  (uses look-around curiosity)
  (uses wander boundary_following)
  (uses wander random_wander)
  (uses go path_following)
  (needs-goal path_following)
  (needs-goal target_nav))

(defrule mode-asks-for-behaviour "Select what the mode uses, once it begins"
  (declare (salience ?*at-once*))
  (mode ?mode)
  (uses ?mode ?behaviour)
  (not (needs-goal ?behaviour))
  =>
  (behaviour-select ?behaviour on))

(defrule goal-asks-for-path "Follow a path to the goal"
  (declare (salience ?*at-once*))
  (mode ?mode)
  (uses ?mode ?behaviour)
  (needs-goal ?behaviour)
  (goal (x-m ?x) (y-m ?y))
  =>
  (behaviour-select ?behaviour on ?x ?y))

(defrule looking-around-avoid-less "On the spot it only has to keep clear of what comes really close: avoiding would turn it back"
  (declare (salience ?*at-once*))
  (mode look-around)
  =>
  (set-threshold avoid_obstacles ?*close*))

(defrule moving-avoid-again "On the move everything near pushes it away"
  (declare (salience ?*at-once*))
  (mode ~look-around)
  (switch (id avoid_obstacles) (threshold ?threshold&:(= ?threshold ?*close*)))
  =>
  (set-threshold avoid_obstacles 0.0))

(defrule mode-has-no-use-for-behaviour "Take back what is selected and belongs to another mode"
  (mode ?mode)
  (behaviour (id ?behaviour) (selected TRUE))
  (uses ~?mode ?behaviour)
  (not (uses ?mode ?behaviour))
  (not (motivation (id ?behaviour) (on FALSE)))
  =>
  (behaviour-select ?behaviour off))
