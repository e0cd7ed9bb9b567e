"""Starting, watching and stopping the processes of a mission (Andersson 1999, section 8.2): manager, executors, what they keep."""
