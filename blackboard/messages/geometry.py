"""Places, poses and arrays."""

import base64
import zlib
from math import cos, hypot, pi, sin
from typing import Annotated, Any, Literal

import numpy as np
import numpy.typing as npt
from msgspec import Meta

from blackboard.messages.base import Angle, Message, Metres

MAX_ARRAY_BYTES = 16_000_000


def wrap_angle(angle_rad: float) -> float:
    """Return the same direction in (-pi, pi]."""
    wrapped = (angle_rad + pi) % (2.0 * pi) - pi
    return pi if wrapped == -pi else wrapped


class Point(Message, frozen=True, kw_only=True):
    """A place; the frame is that of the message it stands in."""

    x_m: Metres
    y_m: Metres

    def extent(self) -> tuple[float, float, float, float]:
        return (self.x_m, self.y_m, self.x_m, self.y_m)


class Pose(Message, frozen=True, kw_only=True):
    """A frame seen from another: `a_from_b` takes coordinates in b to coordinates in a. Heading counter-clockwise from x."""

    x_m: Metres
    y_m: Metres
    heading_rad: Angle

    def __matmul__(self, other: "Pose") -> "Pose":
        """Return a_from_c of a_from_b @ b_from_c."""
        c, s = cos(self.heading_rad), sin(self.heading_rad)
        return Pose(
            x_m=self.x_m + c * other.x_m - s * other.y_m,
            y_m=self.y_m + s * other.x_m + c * other.y_m,
            heading_rad=wrap_angle(self.heading_rad + other.heading_rad),
        )

    def inverse(self) -> "Pose":
        """Return b_from_a of a_from_b."""
        c, s = cos(self.heading_rad), sin(self.heading_rad)
        return Pose(
            x_m=-c * self.x_m - s * self.y_m, y_m=s * self.x_m - c * self.y_m, heading_rad=wrap_angle(-self.heading_rad)
        )

    def transform(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return the point (x_m, y_m) of frame b in frame a."""
        c, s = cos(self.heading_rad), sin(self.heading_rad)
        return (self.x_m + c * x_m - s * y_m, self.y_m + s * x_m + c * y_m)

    def distance_m(self, other: "Pose") -> float:
        """Return the distance between the two origins."""
        return hypot(self.x_m - other.x_m, self.y_m - other.y_m)

    def extent(self) -> tuple[float, float, float, float]:
        return (self.x_m, self.y_m, self.x_m, self.y_m)


IDENTITY = Pose(x_m=0.0, y_m=0.0, heading_rad=0.0)


def interpolate(a: Pose, b: Pose, fraction: float) -> Pose:
    """Return the pose at `fraction` of the way from a (0) to b (1); beyond [0, 1] it extrapolates."""
    turn = wrap_angle(b.heading_rad - a.heading_rad)
    return Pose(
        x_m=a.x_m + fraction * (b.x_m - a.x_m),
        y_m=a.y_m + fraction * (b.y_m - a.y_m),
        heading_rad=wrap_angle(a.heading_rad + fraction * turn),
    )


class PackedArray(Message, frozen=True, kw_only=True):
    """An array in a JSON message: shape and type in the open, the numbers compressed (zlib) and in base64, C order."""

    shape: Annotated[tuple[Annotated[int, Meta(ge=0, le=1_000_000)], ...], Meta(max_length=4)]
    dtype: Literal["uint8", "int32", "float32", "float64"]
    zlib_base64: Annotated[str, Meta(max_length=MAX_ARRAY_BYTES)]

    def __post_init__(self) -> None:
        self.unpack()

    def unpack(self) -> npt.NDArray[Any]:
        """Return the array, read-only; raise ValueError if the bytes are not what shape and dtype promise, or hold NaN."""
        size = np.dtype(self.dtype).itemsize
        for n in self.shape:
            size *= n
        if size > MAX_ARRAY_BYTES:
            raise ValueError(f"an array of {size} bytes is over the limit of {MAX_ARRAY_BYTES}")
        try:
            decompressor = zlib.decompressobj()
            data = decompressor.decompress(base64.b64decode(self.zlib_base64, validate=True), size + 1)
        except (ValueError, zlib.error) as error:
            raise ValueError(f"zlib_base64 does not unpack ({error})") from None
        if len(data) != size:
            raise ValueError(f"zlib_base64 holds {len(data)} bytes, shape and dtype say {size}")
        array = np.frombuffer(data, dtype=self.dtype).reshape(self.shape)
        if self.dtype.startswith("float") and not bool(np.isfinite(array).all()):
            raise ValueError("the array holds NaN or infinity")
        return array


def pack_array(array: npt.NDArray[Any]) -> PackedArray:
    """Pack a uint8, int32, float32 or float64 array of at most four dimensions."""
    data = base64.b64encode(zlib.compress(array.tobytes(), 1)).decode("ascii")
    return PackedArray(shape=tuple(array.shape), dtype=str(array.dtype), zlib_base64=data)  # type: ignore[arg-type]


def check_array(packed: PackedArray, dtype: str, shape: tuple[int | None, ...], name: str) -> None:
    """Raise ValueError unless `packed` has this dtype and shape (None: any length)."""
    fits = len(packed.shape) == len(shape) and all(
        want in (None, got) for want, got in zip(shape, packed.shape, strict=True)
    )
    if packed.dtype != dtype or not fits:
        raise ValueError(f"{name} is {packed.dtype}{list(packed.shape)}, expected {dtype}{list(shape)}")
