; The charging station of the world `lab`, known beforehand: in the lower wall (see `sim/worlds/lab.toml`).

(deffacts lab-station
  (station (x-m 4.3) (y-m 0.0) (heading-rad -1.5708)))
