"""How readings become evidence in the empty-occupied-unknown grid."""

from dataclasses import dataclass

from blackboard.parameters import require

LONGEST_RANGE_CELLS = 1000  # the thesis's 10 m of 1 cm; templates of more take seconds and gigabytes


@dataclass(frozen=True, slots=True, kw_only=True)
class EouGridParams:
    """Cells, reach and steps. One byte a cell: 0 empty, 128 unknown, 255 occupied; steps are in those units.

    `share = 0` and `shadow = False` give the plain scheme of Bou-Ghannam 1992, section 5.2.1.
    """

    cell_m: float = 0.05  # the thesis's second choice: as good for the task as 1 cm, and faster
    post_interval_s: float = 1.0  # changed tiles go to the board this often
    # further off, cones leak behind walls at a slant that do not answer: with 5 m the cells decided wrongly are 3 to 7 times as
    # many in the shipped worlds; beyond it an echo only clears the way up to here
    sonar_range_m: float = 3.0
    no_echo_clears_m: float = 0.0  # silence may be a smooth wall at a slant, so by default it clears nothing
    sonar_down: int = 8  # a cell counts as empty after eight cones, so one stray echo does not decide
    sonar_up: int = 20  # more than down: only the few cells of the band gain, while every cone that passes lowers
    weak_from_fraction: float = 0.75  # of the range: beyond it emptiness is less sure (figure 5.6), the step is halved
    band_m: float = 0.05  # half the width of the band that goes up: one cell, some three sigma of a Polaroid's range
    clear_margin_m: float = 0.1  # nothing is cleared so close before the echo: range noise and the cone's curved front
    share: float = 2.0  # power of the present odds by which an echo's evidence is shared along its arc; 0: all alike
    shadow: bool = True  # what lies behind a cell that is surely occupied says nothing about what is beyond
    blocks_from: int = 192  # a cell casts a shadow from this value on
    laser_range_m: float = 10.0  # beams a degree apart leave 17 cm between them there; longer ones clear up to it
    laser_down: int = 10
    laser_up: int = 48  # a beam's end is one cell, and it is right: three of them make it sure

    def __post_init__(self) -> None:
        require(0.01 <= self.cell_m <= 1.0, "cell_m", self.cell_m, "[0.01, 1] metres")
        require(0.0 <= self.post_interval_s <= 3600, "post_interval_s", self.post_interval_s, "[0, 3600] seconds")
        for name in ("sonar_range_m", "laser_range_m"):
            require(0.2 <= getattr(self, name) <= 50, name, getattr(self, name), "[0.2, 50] metres")
            longest_m = LONGEST_RANGE_CELLS * self.cell_m
            within = f"{longest_m:g} metres, {LONGEST_RANGE_CELLS} cells of cell_m = {self.cell_m:g}"
            require(getattr(self, name) <= longest_m, name, getattr(self, name), within)
        require(0 <= self.no_echo_clears_m <= 50, "no_echo_clears_m", self.no_echo_clears_m, "[0, 50] metres")
        for name in ("sonar_down", "sonar_up", "laser_down", "laser_up"):
            require(1 <= getattr(self, name) <= 127, name, getattr(self, name), "[1, 127]")
        require(0 <= self.weak_from_fraction <= 1, "weak_from_fraction", self.weak_from_fraction, "[0, 1]")
        require(0.01 <= self.band_m <= 1, "band_m", self.band_m, "[0.01, 1] metres")
        require(0 <= self.clear_margin_m <= 1, "clear_margin_m", self.clear_margin_m, "[0, 1] metres")
        require(0 <= self.share <= 10, "share", self.share, "[0, 10]")
        require(129 <= self.blocks_from <= 255, "blocks_from", self.blocks_from, "[129, 255]")
