"""The command line: parse and call. What the verbs do is in `narrows.commands`."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import click

from . import __version__, terminal
from .commands.outcome import Outcome

_SCENE = click.argument("scene", type=click.Path())
_JSON = click.option("--json", "as_json", is_flag=True, help="Print one JSON object, nothing else.")
_PICTURE = click.option(
    "--picture", type=click.Path(), metavar="FILE", help="Draw it: .png (1200 px wide) or .svg."
)
_PLANNER = click.option(
    "--planner",
    default="auto",
    show_default=True,
    metavar="NAME",
    help="auto tries one after the other; or one by name: arc, doorway, manoeuvre, search.",
)


def _examples(*commands: str, head: str = "Examples:") -> str:
    """Return commands as a block of the help text that is not wrapped."""
    return "\b\n" + "\n".join([head, *(f"  {command}" for command in commands)])


@click.group(
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=_examples(
        "narrows plan examples/scenes/door.yaml --picture door.png",
        "narrows drive examples/scenes/door.yaml --record drive.csv",
        head="A first try, with a scene that comes along:",
    ),
)
@click.version_option(__version__, prog_name="narrows")
@click.pass_context
def narrows(context: click.Context) -> None:
    """Plan how a wheelchair gets through narrow places, and prove how clear it is.

    Exit codes: 0 certified, passable, reached; 2 wrong input; 3 proven
    impossible; 4 neither found nor proven, refused, not reached; 130 Ctrl-C.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


@narrows.command(
    "plan",
    short_help="Plan a trajectory that is proven clear.",
    epilog=_examples(
        "narrows plan examples/scenes/door.yaml -o door.csv --picture door.png",
        "narrows plan examples/scenes/door.yaml --json",
        "narrows plan examples/scenes/door.yaml --sensed --picture sensed.png",
    ),
)
@_SCENE
@click.option(
    "-o", "--output", type=click.Path(), metavar="FILE", help="Trajectory: .csv or .json."
)
@_PLANNER
@click.option(
    "--sensed",
    is_flag=True,
    help="Plan by what simulated sensors see, looking again on the way; the true world judges.",
)
@_PICTURE
@_JSON
def plan_command(
    scene: str,
    output: str | None,
    planner: str,
    sensed: bool,
    picture: str | None,
    as_json: bool,
) -> Outcome:
    """Plan a trajectory that is proven clear, or say why there is none.

    FILE of -o is written only if the plan is certified.
    """
    from .commands.plan import PlanFiles, run_plan

    files = PlanFiles(output, picture)
    if sensed:
        from .commands.plan_sensed import run_plan_sensed

        return run_plan_sensed(scene, planner=planner, files=files)
    return run_plan(scene, planner=planner, files=files)


@narrows.command(
    "passable",
    short_help="Decide whether any motion gets through.",
    epilog=_examples(
        "narrows passable examples/scenes/door.yaml",
        "narrows passable examples/scenes/too-narrow.yaml --picture verdict.png",
    ),
)
@_SCENE
@_PICTURE
@_JSON
def passable_command(scene: str, picture: str | None, as_json: bool) -> Outcome:
    """Decide whether any motion of the chair gets from start to goal.

    If none does, this says how many millimetres are missing, and where.
    """
    from .commands.passable import run_passable

    return run_passable(scene, picture=picture)


@narrows.command(
    "verify",
    short_help="Prove or refuse anybody's trajectory.",
    epilog=_examples(
        "narrows plan examples/scenes/door.yaml -o door.csv",
        "narrows verify examples/scenes/door.yaml door.csv",
        "narrows verify examples/scenes/door.yaml door.csv --picture judged.png --json",
    ),
)
@_SCENE
@click.argument("trajectory", type=click.Path())
@_PICTURE
@_JSON
def verify_command(scene: str, trajectory: str, picture: str | None, as_json: bool) -> Outcome:
    """Prove that anybody's TRAJECTORY is clear and keeps the chair's limits, or refuse it.

    TRAJECTORY is CSV with columns x, y, heading [rad] or heading_deg, and t [s] if it
    has times; or JSON: [[x, y, heading], ...].
    """
    from .commands.verify import run_verify

    return run_verify(scene, trajectory, picture=picture)


@narrows.command(
    "drive",
    short_help="Plan, drive in the simulator, judge.",
    epilog=_examples(
        "narrows drive examples/scenes/door.yaml --picture drive.png",
        "narrows drive examples/scenes/door.yaml --save-trajectory door.csv --record drive.csv",
        "narrows drive examples/scenes/somebody-in-the-door.yaml --controller navigator",
        "narrows drive examples/scenes/door.yaml --controller navigator --senses sensors",
        "narrows drive examples/scenes/course.yaml --controller assistant --driver hasty",
    ),
)
@_SCENE
@click.option(
    "--tracker",
    default="lookahead",
    show_default=True,
    metavar="NAME",
    help="Who steers: lookahead, lookahead-paper, linearizing, virtual-target, predictive.",
)
@click.option(
    "--controller",
    metavar="NAME",
    help="Who watches: navigator guards the tracker, stops and waits; assistant helps a driver who "
    "has the plan's way in mind. Default: nobody.",
)
@click.option(
    "--senses",
    metavar="NAME",
    help="What the navigator perceives with. ideal (default): all outlines within 3.7 m, so that "
    "the drive judges the navigator alone; sensors: the chair's laser scanners and depth camera, "
    "noisy and late, and the map that remembers.",
)
@click.option(
    "--silent-from",
    type=click.FloatRange(min=0.0),
    metavar="SECONDS",
    help="When the navigator's senses fall silent for good.",
)
@click.option(
    "--driver",
    metavar="NAME",
    help="Who drives with the assistant: steady (default), brisk, cautious, hasty, shaky, dreamy, "
    "short-sighted, heavy-handed.",
)
@click.option(
    "--regions",
    type=click.Path(),
    metavar="FILE",
    help="The chair's safety regions: read, or computed and written, .npz.",
)
@_PLANNER
@click.option(
    "--trajectory", type=click.Path(), metavar="FILE", help="Drive this instead of planning."
)
@click.option(
    "--save-trajectory", type=click.Path(), metavar="FILE", help="Save the plan: .csv or .json."
)
@click.option("--record", type=click.Path(), metavar="FILE", help="Save the drive in rows: .csv.")
@_PICTURE
@_JSON
def drive_command(
    scene: str,
    tracker: str,
    controller: str | None,
    senses: str | None,
    silent_from: float | None,
    driver: str | None,
    regions: str | None,
    planner: str,
    trajectory: str | None,
    save_trajectory: str | None,
    record: str | None,
    picture: str | None,
    as_json: bool,
) -> Outcome:
    """Plan, drive in the simulator, and judge the drive on the swept body."""
    from .commands.drive import DriveFiles, run_drive

    files = DriveFiles(save_trajectory, record, picture)
    with terminal.progress("driving") as report:
        return run_drive(
            scene,
            tracker=tracker,
            controller=controller,
            senses=senses,
            silent_from=silent_from,
            driver=driver,
            regions=regions,
            planner=planner,
            given=trajectory,
            files=files,
            report=report,
        )


@narrows.command(
    "study",
    short_help="Run an experiment again.",
    epilog=_examples("narrows study", "narrows study door-bezier --out out/door-bezier --jobs 2"),
)
@click.argument("name", required=False)
@click.option("--out", type=click.Path(), metavar="FOLDER", help="Where to; default out/NAME.")
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes.")
@click.option("--resume", is_flag=True, help="Keep the cases done by an earlier run.")
@click.option("--seed", default=0, show_default=True, metavar="N", help="Seed of all randomness.")
@click.option("--scenes", type=click.Path(), metavar="FILE", help="Further scenes, JSON.")
@click.option("--data", type=click.Path(), metavar="FOLDER", help="Maps or recorded frames.")
def study_command(
    name: str | None,
    out: str | None,
    jobs: int,
    resume: bool,
    seed: int,
    scenes: str | None,
    data: str | None,
) -> Outcome:
    """Run an experiment again: its tables, figures and report. Without NAME: which there are."""
    from .commands.study import run_study

    return run_study(name, out=out, jobs=jobs, resume=resume, seed=seed, scenes=scenes, data=data)


@narrows.command(
    "view",
    short_help="Open the scene in 3-D in the browser.",
    epilog=_examples("narrows view examples/scenes/door.yaml", "narrows view --no-open"),
)
@click.argument("scene", type=click.Path(), required=False)
@click.option(
    "--host", default="127.0.0.1", show_default=True, help="Listen here; 0.0.0.0: everywhere."
)
@click.option("--port", default=8080, show_default=True, help="The next free one if it is taken.")
@click.option("--no-open", is_flag=True, help="Do not open the browser.")
def view_command(scene: str | None, host: str, port: int, no_open: bool) -> Outcome:
    """Show the chair, the scene, the plan and the drive in 3-D, in the browser.

    Without SCENE: a door off a corridor. Needs the extra 'view'. What is saved goes into
    the folder this is started in.
    """
    from .commands.view import run_view

    return run_view(scene, host=host, port=port, open_browser=not no_open, say=click.echo)


def main() -> None:
    """Run the command line of this process."""
    terminal.show_what_can_be_shown()
    sys.exit(run(sys.argv[1:]))


def run(arguments: Sequence[str]) -> int:
    """Run what follows `narrows` on the command line and return its exit code."""
    return terminal.run(narrows, arguments)


if __name__ == "__main__":
    main()
