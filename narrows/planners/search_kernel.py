"""The compiled loop of the manoeuvre search: best first over cells of position and heading."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..se2 import Array
from .compiled import compiled
from .search_collision import Solids, advance, clearance_along
from .search_curves import arc_line_arc
from .search_queue import pop, push, slot_of
from .search_tables import Field, Room, Rules

FOUND, EXHAUSTED, SPENT, OUTDONE = 0, 1, 2, 3
"""How a search ended: connected, nothing left to expand, the budget used up, or nothing left that
could cost less than the cost to beat."""


@compiled
def remaining(field: Field, rules: Rules, x: float, y: float, heading: float, goal: Array) -> float:
    """Return a lower bound on the cost left from a pose to the goal's region [m].

    Args:
        field: Bound for the position.
        rules: Radius of the tightest turn.
        x: Position [m].
        y: Position [m].
        heading: Heading [rad].
        goal: x, y, heading, and the tolerances of position and heading, shape (5,).
    """
    column = math.floor((x - field.origin[0]) / field.cell)
    row = math.floor((y - field.origin[1]) / field.cell)
    if column < 0 or column >= field.way.shape[0] or row < 0 or row >= field.way.shape[1]:
        return math.inf
    direct = math.sqrt((x - goal[0]) ** 2 + (y - goal[1]) ** 2)
    way = max(field.way[column, row], direct) - goal[3]
    turn = abs((heading - goal[2] + math.pi) % (2.0 * math.pi) - math.pi) - goal[4]
    return float(max(way, turn * (rules.radius if rules.radius > 0.0 else rules.spot), 0.0))


@compiled
def cell_key(rules: Rules, solids: Solids, x: float, y: float, heading: float, v: float) -> int:
    """Return the number of the cell of position, heading and direction a pose lies in."""
    rows = math.floor(solids.first.shape[1] * solids.cell / rules.cell) + 1
    i = math.floor((x - solids.origin[0]) / rules.cell)
    j = math.floor((y - solids.origin[1]) / rules.cell)
    turn = heading / (2.0 * math.pi)
    k = math.floor((turn - math.floor(turn)) * rules.sectors + 0.5) % rules.sectors
    return int(((i * rows + j) * rules.sectors + k) * 2 + (1 if v < 0.0 else 0))


@compiled
def price(rules: Rules, v: float, length: float, before: float, gap: float) -> float:
    """Return the cost of a move made after one of direction `before`, meeting a least gap [m]."""
    if v == 0.0:
        length *= rules.spot
    cost = length * (1.0 + rules.crowding * (1.0 - min(gap, rules.care) / rules.care))
    return cost + rules.change if before * v < 0.0 else cost


@compiled
def curve_cost(solids: Solids, rules: Rules, node: int, room: Room, limit: float) -> float:
    """Return the cost of the drives in `room.curve` from a node, infinite if not clear [m]."""
    tree = room.tree
    x, y, heading = tree.pose[node, 0], tree.pose[node, 1], tree.pose[node, 2]
    cost, before = 0.0, tree.drive[node, 3]
    for k in range(3):
        v, omega, left = room.curve[k, 0], room.curve[k, 1], room.curve[k, 2]
        while left > 1e-9:
            part = min(left, solids.span)
            gap = clearance_along(
                solids, x, y, heading, v, omega, part, rules.floor, rules.care, room.outline
            )
            if gap < 0.0:
                return math.inf
            cost += price(rules, v, part, before, gap)
            if cost >= limit:
                return math.inf
            x, y, heading = advance(x, y, heading, v, omega, part)
            before = v if v != 0.0 else before
            left -= part
    return cost


@compiled
def connect(
    solids: Solids, rules: Rules, node: int, goal: Array, v: float, room: Room, best: float
) -> float:
    """Look for a clear arc, line and arc to the goal; return the cost of the best way so far.

    A way cheaper than `best` is written to `room.last`.
    """
    tree = room.tree
    x, y, heading = tree.pose[node, 0], tree.pose[node, 1], tree.pose[node, 2]
    for word in range(4):
        length = arc_line_arc(x, y, heading, goal, v, rules.radius, word, room.curve)
        if length == math.inf:
            continue  # there is no such curve, and nothing was written
        if rules.radius == 0.0:
            length = room.curve[1, 2] + rules.spot * (length - room.curve[1, 2])
        if tree.cost[node] + length >= best:
            continue
        cost = tree.cost[node] + curve_cost(solids, rules, node, room, best - tree.cost[node])
        if cost < best:
            best = cost
            for k in range(9):
                room.last[k // 3, k % 3] = room.curve[k // 3, k % 3]
    return best


@compiled
def is_reached(x: float, y: float, heading: float, goal: Array) -> bool:
    """Return whether a pose lies within the goal's tolerances."""
    turn = abs((heading - goal[2] + math.pi) % (2.0 * math.pi) - math.pi)
    near = (x - goal[0]) ** 2 + (y - goal[1]) ** 2 <= goal[3] ** 2
    return bool(near and turn <= goal[4])


@compiled
def add(
    room: Room,
    count: int,
    parent: int,
    x: float,
    y: float,
    heading: float,
    cost: float,
    left: float,
) -> None:
    """Write the node `count`, whose move is not yet known."""
    tree = room.tree
    tree.pose[count, 0], tree.pose[count, 1], tree.pose[count, 2] = x, y, heading
    for k in range(4):
        tree.drive[count, k] = 0.0
    tree.parent[count], tree.cost[count] = parent, cost
    room.left[count] = left
    room.is_closed[count] = False


@compiled
def expand(
    solids: Solids,
    field: Field,
    rules: Rules,
    goal: Array,
    room: Room,
    node: int,
    state: NDArray[np.int64],
) -> None:
    """Add the nodes that one move from a node leads to.

    Args:
        solids: What not to touch.
        field: Bound on the way left.
        rules: Moves and costs.
        goal: As in `remaining`.
        room: Working arrays.
        node: The node.
        state: Number of nodes and length of the queue, shape (2,), changed.
    """
    tree = room.tree
    x0, y0, heading0 = tree.pose[node, 0], tree.pose[node, 1], tree.pose[node, 2]
    before = tree.drive[node, 3]
    for move in range(rules.drives.shape[0]):
        v, omega, length = rules.drives[move, 0], rules.drives[move, 1], rules.drives[move, 2]
        x, y, heading = advance(x0, y0, heading0, v, omega, length)
        way = remaining(field, rules, x, y, heading, goal)
        if way == math.inf:
            continue
        direction = v if v != 0.0 else before
        key = cell_key(rules, solids, x, y, heading, direction)
        slot = slot_of(room.table, key)
        known = room.table[slot, 1] if room.table[slot, 0] == key else -1
        cost = tree.cost[node] + price(rules, v, length, before, rules.care)
        if known >= 0 and (room.is_closed[known] or tree.cost[known] <= cost):
            continue
        gap = clearance_along(
            solids, x0, y0, heading0, v, omega, length, rules.floor, rules.care, room.outline
        )
        if gap < 0.0:
            continue
        cost = tree.cost[node] + price(rules, v, length, before, gap)
        if known >= 0:
            if tree.cost[known] <= cost:
                continue
            room.is_closed[known] = True
        count = state[0]
        room.table[slot, 0], room.table[slot, 1] = key, count
        add(room, count, node, x, y, heading, cost, way)
        tree.drive[count, 0], tree.drive[count, 1] = v, omega
        tree.drive[count, 2], tree.drive[count, 3] = length, direction
        state[1] = push(room.keys, room.items, state[1], cost + rules.weight * way, count)
        state[0] = count + 1


@compiled
def grow(
    solids: Solids,
    field: Field,
    rules: Rules,
    roots: Array,
    goal: Array,
    room: Room,
    state: NDArray[np.int64],
    bound: Array,
) -> int:
    """Search from root poses until a node connects to the goal; return how it ended.

    Args:
        solids: What not to touch.
        field: Bound on the way left.
        rules: Moves and costs.
        roots: x, y, heading and cost to begin with, shape (R, 4).
        goal: x, y, heading, tolerances of position and heading, shape (5,).
        room: Working arrays, written.
        state: Number of nodes, length of the queue, expansions, node connected; shape (4,).
        bound: Cost to beat, shape (1,), changed to the cost of what was found [m].
    """
    for k in range(roots.shape[0]):
        x, y, heading = roots[k, 0], roots[k, 1], roots[k, 2]
        way = remaining(field, rules, x, y, heading, goal)
        add(room, k, -1, x, y, heading, roots[k, 3], way)
        key = roots[k, 3] + rules.weight * way
        state[1] = push(room.keys, room.items, state[1], key, k)
    state[0] = roots.shape[0]
    forward = reverse = False
    for move in range(rules.drives.shape[0]):
        forward = forward or rules.drives[move, 0] > 0.0
        reverse = reverse or rules.drives[move, 0] < 0.0
    best, found = bound[0], False
    while state[1] > 0:
        key, node = pop(room.keys, room.items, state[1])
        state[1] -= 1
        if found and key >= best:
            return FOUND
        if room.is_closed[node] or room.tree.cost[node] + room.left[node] >= best:
            continue
        if state[2] >= rules.budget or state[0] + rules.drives.shape[0] > len(room.left):
            return FOUND if found else SPENT
        room.is_closed[node] = True
        state[2] += 1
        pose, cost = room.tree.pose[node], room.tree.cost[node]
        if cost < best and is_reached(pose[0], pose[1], pose[2], goal):
            best, found, state[3], bound[0] = cost, True, node, cost
            room.last[0, 2] = room.last[1, 2] = room.last[2, 2] = 0.0
        if state[2] == 1 or state[2] % (math.floor(room.left[node] / rules.attempts) + 1) == 0:
            for v in (1.0, -1.0):
                if (v > 0.0 and forward) or (v < 0.0 and reverse):
                    cost = connect(solids, rules, node, goal, v, room, best)
                    if cost < best:
                        best, found, state[3], bound[0] = cost, True, node, cost
        expand(solids, field, rules, goal, room, node, state)
    if found:
        return FOUND
    return EXHAUSTED if best == math.inf else OUTDONE
