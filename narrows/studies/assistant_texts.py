"""What the driving-assistant study's report says around its tables."""

SETUP = """The Xeno, 0.66 m wide, drives there and back on a course of 11 x 6 m drawn after the
description in [DrivingAssistant]: two doors of 0.80 m, turned into at right angles on the way
back, and a bend of 1.4 m. Runs I and II are by joystick, III and IV by head joystick, I and III
alone, II and IV assisted; all keep the same limits of speed, acceleration and jerk. The eight
drivers are scripts with traits of our own (`simulation/driver_traits.py`): their pace and errors
were tuned to the speeds and the collisions of the paper's unassisted runs I and III and left alone
since. Control 20 times a second, two scanners 8 times; the chair's wheels slip by 1 % and it knows
how it moves by its encoders. A collision is any touch of the true body; there is no contact
dynamics. What is unknown counts as free, as in the paper."""

TESTS = """Changes are of the means over drivers, each the mean of its drives. p: Wilcoxon's signed
ranks, paired by driver (eight of ours, the paper's subjects), and Fisher's exact test for the
drives that touched. Intervals are 95 %: bootstrap (BCa) for means, Wilson's for rates. Our drivers
were tuned on runs I and III, so those rows are no prediction; II and IV are. A mean speed is the
mean of distance by time; with the aborted drive the paper's III has 0.329 m/s."""

MAP = """The grid of 2 cm cells was learned from simulated scans and odometry by aligning each scan
to the map so far; a particle filter of 150 particles then found the drives in it, map untouched.
Drawn is what the filter found, as in Fig. 8."""

DOORS = """The chair starts 2.1 m before the wall, beside the middle of the door and askew, and is
to drive through. `helped`: the assistant also blends the steering towards a path through the door
it senses, planned and certified by `narrows.plan`, at 0.45 m/s at most. Times and distances are of
the drives that got through."""

FAULTS = """On the course, by joystick, assisted. `unseeing`: the way driven while the newest scan
was too old to be trusted at all; the chair brakes then, and this is its braking."""

PEOPLE = """Meetings that ended in a touch while the chair moved. The driver pushes the stick
forward and never looks; somebody gets in the way of the chair at 0.8 m/s, at 0.5 to 1.4 m/s. The
safety regions know nothing of motion: who walks at a chair is touched while it still brakes if
they come from near enough."""
