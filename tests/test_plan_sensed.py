"""`narrows plan --sensed`: its contract on the command line."""

import json
from pathlib import Path

import pytest

from narrows.cli import run

SCENES = Path(__file__).parents[1] / "examples" / "scenes"


@pytest.mark.slow
def test_a_sensed_plan_says_how_often_it_looked_and_writes_what_is_certified(tmp_path, capsys):
    scene, file, picture = SCENES / "door.yaml", tmp_path / "door.csv", tmp_path / "door.png"
    call = ["plan", str(scene), "--sensed", "--json", "-o", str(file), "--picture", str(picture)]
    assert run(call) == 0
    fields = json.loads(capsys.readouterr().out)
    assert (fields["status"], fields["planner"]) == ("certified", "sensed")
    assert fields["views"] == fields["replans"] + 1 >= 2
    assert picture.stat().st_size > 10_000
    assert run(["verify", str(scene), str(file), "--json"]) == 0
    judged = json.loads(capsys.readouterr().out)
    assert judged["clearance_m"] == pytest.approx(fields["clearance_m"], abs=1e-3)


def test_where_no_way_is_seen_nothing_is_written_and_the_reason_told(tmp_path, capsys):
    scene, file = tmp_path / "cell.yaml", tmp_path / "cell.csv"
    scene.write_text(
        "vehicle: narrow-arcs\n"
        "world:\n"
        "  bounds: [-1.5, -1.5, 4.5, 1.5]\n"
        "  solids:\n"
        "    - {polygon: [[1.5, -1.5], [1.6, -1.5], [1.6, 1.5], [1.5, 1.5]], name: wall}\n"
        "start: {x: 0, y: 0, heading_deg: 0}\n"
        "goal: {x: 3, y: 0, heading_deg: 0}\n"
    )
    assert run(["plan", str(scene), "--sensed", "--json", "-o", str(file)]) == 4
    told = capsys.readouterr()
    fields = json.loads(told.out)
    assert (fields["status"], fields["views"], fields["replans"]) == ("not_found", 1, 0)
    assert fields["clearance_m"] is None
    assert "what is seen leaves no way to the goal" in fields["reason"]
    assert "nothing was written" in told.err
    assert not file.exists()
