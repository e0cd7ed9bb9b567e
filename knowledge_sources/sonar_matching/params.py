"""What the matching of sonar echoes goes by."""

from dataclasses import dataclass

from blackboard.parameters import require


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarMatcherParams:
    """Window, forward model, score, and what odometry is believed to be wrong by."""

    # the window
    window_scans: int = (
        15  # 3 s of a ring at 5 Hz, about a metre: enough bearings to fix a pose, too short for odometry to bend
    )
    match_every_scans: int = 5  # once a second: the pose drifts by a centimetre or two meanwhile
    used_every_scans: int = 2  # neighbours say nearly the same again; every other one halves the time
    least_way_m: float = 0.02  # a scan from where the last one was taken tells nothing new; less than a cell
    least_turn_rad: float = 0.02  # the same at 2 m: 4 cm
    # the grid that is matched to
    cell_m: float = 0.05  # the band of a wall is some cells wide, and must stay narrower than what is to be told apart
    reach_m: float = 3.0  # beyond it cones leak behind walls at a slant (as in the empty-occupied-unknown grid)
    patch_m: float = 3.0  # a new patch of the map begins this far from the others: small enough to be rigid
    match_patches: int = 2  # at most so many are matched at a time
    # the forward model
    rays: int = 7  # in a cone: 0.11 m apart at 1.5 m for a cone of 25 degrees, two or three cells
    occupied_from: int = 192  # as everywhere on the board: half way from unknown to sure
    empty_below: int = 110  # two cones passed it; a cell that much above unknown is known as well
    known_fraction: float = 1.0  # of cells on the way to an echo: fewer, and the echo is of a new place
    band_middle: float = (
        0.5  # a wall stands in the middle of its band of occupied cells: echoes scatter about where it is
    )
    neutral_m: float = (
        0.12  # an echo that may have come from an unknown place counts as so far off at most: an average match
    )
    # the score
    sigma_m: float = (
        0.1  # echo against grid: 0.05 on true poses, as much again for the pose error that the grid was built with
    )
    outlier_fraction: float = (
        0.1  # echoes that have nothing to do with the grid: cross-talk, people, corners that leaked
    )
    independence: float = (
        0.5  # echoes of neighbouring cones come from the same walls of the same grid: two tell what one does
    )
    least_fit: float = 0.5  # of the echoes that a match must explain: else the map is another one
    least_echoes: int = 8  # as few as three walls need, with some to spare
    # one sigma of a match beside what its score says: matches to one stretch of wall err alike. On true poses 0.03 m and 1 degree
    # were seen in three worlds; twice that, since about four matches see the same stretch
    floor_m: float = 0.05
    floor_rad: float = 0.03
    trust_probability: float = (
        0.999  # a jump that odometry's uncertainty makes less likely than one in a thousand is refused
    )
    # one sigma of odometry's systematic errors, which are estimated on the way
    distance_scale: float = 0.04  # worn tyres, carpets
    turn_scale: float = 0.03
    drift_rad_per_m: float = 0.01  # 6 degrees in 10 m
    latency_sigma_s: float = 0.1  # stamps of sonars may be as late as a scan takes; estimated on the way as well
    # and of its random ones, over a metre or a radian; they grow with the root of the way. Half a degree a metre: a drive of a
    # hundred metres on good wheels; larger ones would let each match turn the map anew
    distance_noise_m: float = 0.02
    sideways_noise_m: float = 0.01
    heading_noise_rad: float = 0.006
    turn_noise_rad: float = 0.02

    def __post_init__(self) -> None:
        require(3 <= self.window_scans <= 200, "window_scans", self.window_scans, "[3, 200]")
        for name in ("match_every_scans", "used_every_scans"):
            within = f"[1, {self.window_scans}], at most the window"
            require(1 <= getattr(self, name) <= self.window_scans, name, getattr(self, name), within)
        require(0 <= self.least_way_m <= 1, "least_way_m", self.least_way_m, "[0, 1] metres")
        require(0 <= self.least_turn_rad <= 1, "least_turn_rad", self.least_turn_rad, "[0, 1] rad")
        require(0.02 <= self.cell_m <= 0.5, "cell_m", self.cell_m, "[0.02, 0.5] metres")
        require(0.2 <= self.reach_m <= 20, "reach_m", self.reach_m, "[0.2, 20] metres")
        require(1 <= self.rays <= 101, "rays", self.rays, "[1, 101]")
        require(129 <= self.occupied_from <= 255, "occupied_from", self.occupied_from, "[129, 255]")
        require(1 <= self.empty_below <= 127, "empty_below", self.empty_below, "[1, 127]")
        require(0 <= self.known_fraction <= 1, "known_fraction", self.known_fraction, "[0, 1]")
        require(0 <= self.band_middle <= 1, "band_middle", self.band_middle, "[0, 1]")
        require(0.5 <= self.patch_m <= 100, "patch_m", self.patch_m, "[0.5, 100] metres")
        require(1 <= self.match_patches <= 10, "match_patches", self.match_patches, "[1, 10]")
        require(0 <= self.latency_sigma_s <= 1, "latency_sigma_s", self.latency_sigma_s, "[0, 1] seconds")
        require(0 <= self.floor_m <= 1, "floor_m", self.floor_m, "[0, 1] metres")
        require(0 <= self.floor_rad <= 1, "floor_rad", self.floor_rad, "[0, 1] rad")
        require(0.005 <= self.sigma_m <= 2, "sigma_m", self.sigma_m, "[0.005, 2] metres")
        require(0 < self.outlier_fraction < 1, "outlier_fraction", self.outlier_fraction, "(0, 1)")
        require(0 < self.independence <= 1, "independence", self.independence, "(0, 1]")
        require(3 <= self.least_echoes <= 1000, "least_echoes", self.least_echoes, "[3, 1000]")
        require(0 <= self.least_fit <= 1, "least_fit", self.least_fit, "[0, 1]")
        require(0 <= self.neutral_m <= 10, "neutral_m", self.neutral_m, "[0, 10] metres")
        require(0.5 <= self.trust_probability < 1, "trust_probability", self.trust_probability, "[0.5, 1)")
        for name in ("distance_scale", "turn_scale", "drift_rad_per_m"):
            require(0 <= getattr(self, name) <= 0.5, name, getattr(self, name), "[0, 0.5]")
        for name in ("distance_noise_m", "sideways_noise_m", "heading_noise_rad", "turn_noise_rad"):
            require(0 < getattr(self, name) <= 1, name, getattr(self, name), "(0, 1]")
