; Focus of attention: which knowledge sources matter most in which mode.
; Reads  mode, agenda      Sets  the ratings of knowledge sources
; (Bou-Ghannam 1992, section 4.4: the control module decides which knowledge source is of most use now.)

(defrule looking-around-focus-on-targets "What is seen now decides where to go next: bring the targets up to date first"
  (mode look-around)
  =>
  (focus frontier_targets 30)
  (focus line_end_targets 30))

(defrule under-way-focus-on-ways "On the way the route matters more than new targets"
  (mode go)
  =>
  (focus routes 40)
  (focus frontier_targets 3)
  (focus line_end_targets 3))

(defrule backlog-rest-line-ends "More work waits than a cycle can do: until the mode changes, leave out what can wait"
  (declare (salience ?*choose*))
  (agenda (dropped ?dropped&:(> ?dropped 0)))
  =>
  (focus line_end_targets off))
