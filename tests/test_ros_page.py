"""The ROS node of docs/ros.md drives a chair, with stand-ins for the few parts of ROS it uses."""

import math
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

PAGE = Path(__file__).parents[1] / "docs" / "ros.md"
SCENE = """
vehicle: narrow-arcs
world: {solids: [{polygon: [[0, 0.6], [3, 0.6], [3, 0.7], [0, 0.7]]}]}
start: {x: 0, y: 0, heading_deg: 0}
goal: {x: 1.5, y: -0.4, heading_deg: 0}
"""


@dataclass
class Chair:
    """A unicycle that obeys at once, in a world whose clock goes on by timer calls."""

    pose: np.ndarray = field(default_factory=lambda: np.zeros(3))
    time: float = 0.0
    stamp_lag: float = 0.0
    lost: bool = False
    sent: list = field(default_factory=list)


@dataclass
class Instant:
    """A time or a duration."""

    seconds: float = 0.0

    @property
    def nanoseconds(self):
        return self.seconds * 1e9

    def __sub__(self, other):
        """Return the duration between two times."""
        return Instant(self.seconds - other.seconds)

    @staticmethod
    def from_msg(stamp):
        return Instant(stamp)


class Lost(Exception):
    """Stands in for tf2_ros.TransformException."""


def twist():
    return SimpleNamespace(linear=SimpleNamespace(x=0.0), angular=SimpleNamespace(z=0.0))


def stand_ins(chair):
    """Return modules by name that behave as the node expects of ROS, around one chair."""

    class Node:
        def __init__(self, name):
            self.name = name

        def create_publisher(self, kind, topic, depth):
            return SimpleNamespace(publish=chair.sent.append)

        def create_timer(self, period, call):
            self.period, self.call = period, call

        def get_clock(self):
            return SimpleNamespace(now=lambda: Instant(chair.time))

        def get_logger(self):
            return SimpleNamespace(info=lambda _: None, warning=lambda _: None)

    class Buffer:
        def lookup_transform(self, target, source, time):
            assert (target, source) == ("map", "base_link")
            if chair.lost:
                raise Lost
            x, y, heading = chair.pose
            rotation = SimpleNamespace(z=math.sin(heading / 2), w=math.cos(heading / 2))
            transform = SimpleNamespace(translation=SimpleNamespace(x=x, y=y), rotation=rotation)
            header = SimpleNamespace(stamp=chair.time - chair.stamp_lag)
            return SimpleNamespace(header=header, transform=transform)

    def spin(node):
        while chair.time < 60.0:
            node.call()
            v, omega = chair.sent[-1].linear.x, chair.sent[-1].angular.z
            middle = chair.pose[2] + 0.5 * omega * node.period
            step = np.array([v * math.cos(middle), v * math.sin(middle), omega])
            chair.pose = chair.pose + node.period * step
            chair.time += node.period

    parts = {
        "rclpy": {"init": lambda: None, "spin": spin},
        "rclpy.node": {"Node": Node},
        "rclpy.time": {"Time": Instant},
        "geometry_msgs": {},
        "geometry_msgs.msg": {"Twist": twist},
        "tf2_ros": {
            "Buffer": Buffer,
            "TransformException": Lost,
            "TransformListener": lambda buffer, node: None,
        },
    }
    modules = {name: ModuleType(name) for name in parts}
    for name, values in parts.items():
        vars(modules[name]).update(values)
    return modules


@pytest.fixture
def drive(tmp_path, monkeypatch):
    """Run the page's node on a scene with a chair; return what it ended with."""
    source = re.findall(r"^```python\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)[0]
    (tmp_path / "scene.yaml").write_text(SCENE)

    def run(chair):
        for name, module in stand_ins(chair).items():
            monkeypatch.setitem(sys.modules, name, module)
        monkeypatch.setattr(sys, "argv", ["node", str(tmp_path / "scene.yaml")])
        space = {"__name__": "node"}
        exec(compile(source, "docs/ros.md", "exec"), space)
        try:
            space["main"]()
        except SystemExit as end:
            return "arrived" if end.code is None else str(end.code)
        return "still driving"

    return run


def test_the_node_drives_its_plan_and_stands(drive):
    chair = Chair()
    assert drive(chair) == "arrived"
    assert math.dist(chair.pose[:2], (1.5, -0.4)) < 0.06  # the goal's tolerance and a centimetre
    assert chair.sent[-1].linear.x == 0.0


@pytest.mark.parametrize("fault", [{"lost": True}, {"stamp_lag": 0.5}])
def test_the_node_stands_where_the_pose_is_lost_or_old(drive, fault):
    chair = Chair(**fault)
    assert drive(chair) == "still driving"
    assert all(sent.linear.x == 0.0 == sent.angular.z for sent in chair.sent)


def test_the_node_refuses_to_begin_elsewhere(drive):
    chair = Chair(pose=np.array([0.3, 0.0, 0.0]))
    assert "0.30 m" in drive(chair)
    assert not chair.sent
