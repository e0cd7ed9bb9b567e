; Battery: go home when it runs low, dock there, and go on when it is charged.
; Reads  battery, station, mode, behaviour, motivation      Sets  mode, goal, the mission's end
; Where the station is, is known beforehand: a fact in a file of its own for each place (as `lab-station.clp`).
; (Bou-Ghannam 1992, section 4.2.1: charge-battery tunes avoid-obstacles down as it comes near; docking does the last piece.)

(defglobal ?*charge-low* = 0.2)    ; of a full battery: enough for the way home from anywhere
(defglobal ?*charge-enough* = 0.8) ; so far it charges
(defglobal ?*way-ends-m* = 1.2)    ; before the station, where following a path ends and charge-battery goes on
(defglobal ?*trips-home* = 3)      ; so often it goes home before it gives up

(deftemplate station "A charging station, and the heading of a robot that charges there"
  (slot x-m) (slot y-m) (slot heading-rad))

(deffacts charging "charge_battery and docking are selected below, with the station as their parameters"
  (uses home path_following)
  (uses charge charge_battery)
  (uses dock docking)
  (needs-goal charge_battery)
  (needs-goal docking)
  (went-home 0))

(defrule battery-low-go-home "Whatever it is doing, there is enough left for the way home"
  (declare (salience ?*urgent*))
  (battery (charge-fraction ?charge&:(< ?charge ?*charge-low*)))
  (station)
  ?mode <- (mode ~home&~charge&~dock&~done)
  =>
  (retract ?mode)
  (assert (mode home)))

(defrule home-forget-goal "Where it was going does not count on the way home"
  (declare (salience ?*urgent*))
  (mode home)
  ?goal <- (goal (target ~station))
  =>
  (retract ?goal))

(defrule home-find-way "Follow a path to before the station"
  (declare (salience ?*at-once*))
  (mode home)
  (not (goal))
  (station (x-m ?x) (y-m ?y) (heading-rad ?heading))
  =>
  (assert (goal (target station) (length-m 0.0) (since-s (now))
    (x-m (- ?x (* ?*way-ends-m* (cos ?heading)))) (y-m (- ?y (* ?*way-ends-m* (sin ?heading)))))))

(defrule home-approach-station "It is there, or there is no way that is known: go straight to the station"
  ?mode <- (mode home)
  ?goal <- (goal (target station))
  (motivation (id path_following) (number ?asked))
  (behaviour (id path_following) (acknowledged ?asked) (outcome reached|blocked))
  =>
  (retract ?mode ?goal)
  (assert (mode charge)))

(defrule charge-approach "Go before the station and face it"
  (declare (salience ?*at-once*))
  (mode charge)
  (station (x-m ?x) (y-m ?y) (heading-rad ?heading))
  =>
  (behaviour-select charge_battery on ?x ?y ?heading))

(defrule before-station-dock "The last piece"
  (declare (salience ?*reached*))
  ?mode <- (mode charge)
  (motivation (id charge_battery) (number ?asked))
  (behaviour (id charge_battery) (acknowledged ?asked) (outcome reached))
  =>
  (retract ?mode)
  (assert (mode dock)))

(defrule dock-at-station "Dock"
  (declare (salience ?*at-once*))
  (mode dock)
  (station (x-m ?x) (y-m ?y) (heading-rad ?heading))
  =>
  (behaviour-select docking on ?x ?y ?heading))

(defrule charged-choose "Enough to go on"
  (declare (salience ?*reached*))
  ?mode <- (mode dock)
  (behaviour (id docking) (outcome reached))
  (battery (charge-fraction ?charge&:(>= ?charge ?*charge-enough*)))
  ?went <- (went-home ?)
  =>
  (retract ?mode ?went)
  (assert (mode choose) (went-home 0)))

(defrule station-blocked-go-home-again "It did not get there, or nothing charged it: once more"
  (declare (salience ?*blocked*))
  ?mode <- (mode ?which&charge|dock)
  (uses ?which ?behaviour)
  (motivation (id ?behaviour) (number ?asked))
  (behaviour (id ?behaviour) (acknowledged ?asked) (outcome blocked))
  ?went <- (went-home ?n&:(< ?n (- ?*trips-home* 1)))
  =>
  (retract ?mode ?went)
  (assert (mode home) (went-home (+ ?n 1))))

(defrule station-blocked-give-up "It has been tried often enough"
  (declare (salience ?*blocked*))
  ?mode <- (mode ?which&charge|dock)
  (uses ?which ?behaviour)
  (motivation (id ?behaviour) (number ?asked))
  (behaviour (id ?behaviour) (acknowledged ?asked) (outcome blocked))
  (went-home ?n&:(>= ?n (- ?*trips-home* 1)))
  =>
  (retract ?mode)
  (assert (mode done))
  (post (mission (state given-up) (detail "the battery is low, and its station cannot be reached or does not charge"))))
