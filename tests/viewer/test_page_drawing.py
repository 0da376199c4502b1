"""What is drawn says what is proven: nothing uncertified looks certified."""

import numpy as np
import pytest
import shapely

from narrows.scene import load_scene
from narrows.vehicle import Vehicle
from narrows.viewer import palette
from narrows.viewer.motion_shapes import swept_floor, thinned
from narrows.viewer.page_camera import camera
from narrows.viewer.page_drawing import SceneDrawing, rgb
from narrows.viewer.page_motion import Curve, Motion
from narrows.viewer.page_plots import curve_data, limits
from narrows.viewer.page_senses import region_outline, zone_outline

CHAIR = Vehicle.rectangle(1.0, 0.7, 0.25)
AHEAD = np.column_stack([np.linspace(0, 2, 101), np.zeros(101), np.zeros(101)])


class Recorded:
    """A scene that keeps what was added to it."""

    def __init__(self):
        """Start empty."""
        self.added = {}

    def __getattr__(self, kind):
        """Return what takes down a call."""

        def add(name, *arguments, **options):
            handle = Handle(self, name)
            self.added[name] = (kind, arguments, options)
            return handle

        return add

    def get_handle_by_name(self, name):
        return Handle(self, name) if name in self.added else None


class Handle:
    """What viser hands back."""

    def __init__(self, scene, name):
        """Keep where it belongs."""
        self.scene, self.name = scene, name

    def remove(self):
        self.scene.added.pop(self.name, None)


def drawn(fault):
    scene = Recorded()
    SceneDrawing(scene).motion("drive", CHAIR, AHEAD, fault=fault)
    return scene.added


def test_a_motion_with_a_fault_is_dashed_red_and_says_so():
    fine, faulty = drawn(""), drawn("driven with contact")
    assert faulty["/drive/fault"][1][0] == "driven with contact"
    assert "/drive/fault" not in fine
    _, (segments, colour), _ = faulty["/drive/forward"]
    assert colour == rgb(palette.REFUSED)
    assert len(segments) == pytest.approx(0.5 * 100, abs=6)  # every other dash of 6 segments
    _, (segments, colour), _ = fine["/drive/forward"]
    assert colour != rgb(palette.REFUSED)
    assert len(segments) == 100


def test_driving_in_reverse_has_its_own_colour():
    scene = Recorded()
    back = AHEAD[::-1]
    SceneDrawing(scene).motion("plan", CHAIR, np.concatenate([AHEAD, back[1:]]))
    assert scene.added["/plan/reverse"][1][1] == rgb(palette.REVERSE)
    assert len(scene.added["/plan/forward"][1][0]) == len(scene.added["/plan/reverse"][1][0]) == 100


def test_drawing_again_takes_away_what_was_drawn_before():
    scene = Recorded()
    drawing = SceneDrawing(scene)
    drawing.motion("drive", CHAIR, AHEAD, fault="driven with contact")
    drawing.motion("drive", CHAIR, AHEAD)
    assert "/drive/fault" not in scene.added
    drawing.remove("drive")
    assert not scene.added


def test_the_floor_swept_is_that_of_the_body():
    area = swept_floor(CHAIR.outline, AHEAD)
    assert area.area == pytest.approx(0.7 * 3.0, rel=1e-6)
    assert area.bounds == pytest.approx((-0.25, -0.35, 2.75, 0.35))


def test_thinning_keeps_both_ends_and_two_centimetres():
    poses = np.column_stack([np.linspace(0, 1, 1001), np.zeros(1001), np.zeros(1001)])
    rows = thinned(poses)
    np.testing.assert_array_equal(rows[[0, -1]], poses[[0, -1]])
    assert np.diff(rows[:, 0]).max() <= 0.0211
    assert len(rows) < 60


@pytest.mark.parametrize("aspect", [0.5, 1.0, 1.9])
@pytest.mark.parametrize("name", ["door", "l-corridor", "under-the-table"])
def test_the_camera_sees_the_whole_world(name, aspect):
    scene = load_scene(f"examples/scenes/{name}.yaml")
    seen = camera(scene, aspect)
    eye, middle = np.array(seen.position), np.array(seen.look_at)
    ahead = (middle - eye) / np.linalg.norm(middle - eye)
    right = np.cross(ahead, [0, 0, 1])
    right /= np.linalg.norm(right)
    x0, y0, x1, y1 = scene.world.bounds
    corners = np.array([[x, y, z] for x in (x0, x1) for y in (y0, y1) for z in (0.0, 0.8)]) - eye
    depth, tangent = corners @ ahead, np.tan(0.5 * seen.fov)
    assert (np.abs(corners @ right) <= depth * tangent * aspect).all()
    assert (np.abs(corners @ np.cross(right, ahead)) <= depth * tangent).all()


def test_the_upright_line_of_a_plot_stands_at_the_time_and_bends_no_curve():
    times, values = np.linspace(0, 4, 5), np.array([[0.0], [1.0], [2.0], [3.0], [4.0]])
    t, line, upright = curve_data(times, values, 2.5, most=3.5)
    np.testing.assert_allclose(line, t)  # still the identity
    np.testing.assert_array_equal(t[~np.isnan(upright)], [2.5, 2.5])
    assert np.nanmin(upright) == 0.0
    assert np.nanmax(upright) == 3.5
    assert limits(np.full((3, 1), np.nan)) == (0.0, 1.0)


def test_a_motion_is_between_its_rows():
    curve = Curve("x", ("x",), np.zeros((2, 1)))
    motion = Motion(
        "plan",
        np.array([0.0, 2.0]),
        np.array([[0.0, 0, 0], [1, 0, 0]]),
        (curve,),
        states=("a", "b"),
    )
    assert motion.pose(1.0)[0] == 0.5
    assert (motion.state(1.9), motion.state(2.0), motion.moment(1.0)) == ("a", "b", None)


def test_the_zone_is_drawn_no_further_than_the_obstacle():
    from narrows.interfaces import Percept
    from narrows.reactive.zone_shape import ZoneShape

    shape = ZoneShape.around(CHAIR)
    whole = zone_outline(shape, 0.0, Percept(0.0, np.zeros((0, 3))))[0]
    np.testing.assert_allclose(whole, shape.section(0.0), atol=1e-12)
    ahead = 0.9 * whole[:, 0].max()
    cut = zone_outline(shape, 0.0, Percept(0.0, np.array([[ahead, 0.0, 0.5]])))[0]
    assert cut[0, 0] == pytest.approx(ahead)
    assert (np.hypot(*cut.T) <= np.hypot(*whole.T) + 1e-12).all()


@pytest.mark.slow
def test_the_region_that_is_drawn_reaches_as_far_as_the_chair_needs_to_brake():
    from narrows.reactive.safety_regions import RegionOptions, SafetyRegions

    options = RegionOptions(directions=8, levels=4, cell=0.05)
    regions = SafetyRegions.compute(CHAIR, options)
    (ring,) = region_outline(regions, 0.6, 0.0)
    assert ring[:, 0].max() > 0.75 + 0.6**2 / 2  # it brakes at 1 m/s^2 from 0.6 m/s
    reached = regions.region(0.6, 0.0).sum() * options.cell**2
    assert shapely.Polygon(ring).area == pytest.approx(reached, rel=0.05)  # smoothed by a cell
