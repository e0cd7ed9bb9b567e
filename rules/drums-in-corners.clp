; A-priori knowledge: drums of this size usually stand in corners. Leave this file out, and the robot has to look everywhere.

(deffacts drums-in-corners (usually-stands-in drum corner))
