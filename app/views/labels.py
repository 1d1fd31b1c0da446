"""Labels in the picture of a scene: loads, ground, joint, slope.

Anchors of words are px of the figure; the picture's own lines are px from the middle of
the foot.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.views.acts import Arrows, anchor_of, color_of, text_of
from app.views.colors import FORCE, REFERENCE
from app.views.colors import GROUND as GROUND_COLOR
from app.views.layout import EACH, FOOTING, GROUND, is_opposite
from app.views.obstacles import ALONG, Obstacles
from app.views.picture import Columns, Picture
from app.views.supports import ground_edge
from app.views.words import Word, around, box_of, in_rows, inside, is_inside, meets
from solver.arrays import Array
from solver.discrete.structure import Act
from solver.files.amounts import number

NAMED = 0.4
"""Largest length of the name of a joint over that of all bodies."""
NAME = 14.0
ASKEW = 0.3
"""Distance of the name of a joint from its end, px, and slope of a joint from which on
its name is next to it and not above or below."""
FAR = 1.5
"""Distance of words of a weight from its arrow, over that of rows, from which on a line
leads there."""
MOST_ROWS = 3
"""Largest number of rows by which a word makes way for others, bodies and ground."""


def labels_of(picture: Picture) -> tuple[Columns, Columns]:
    """Columns of all labels on a picture, and of leader lines to distant arrows.

    Words are moved off each other and off arrows.
    """
    obstacles = Obstacles(picture)
    words = _words_of_loads(picture, obstacles)
    if not picture.layout.canvas.is_bare:
        words += _name_of_ground(picture)
        words += _name_of_joint(picture, obstacles)
    if picture.description.tilt is not None:
        words.append(_slope(picture))
    words = _apart(inside(picture.layout, words), obstacles)
    x, y = np.reshape([word.anchor for word in words], (-1, 2)).T
    columns = {
        "x": x,
        "y": y,
        "text": [word.text for word in words],
        "text_align": [word.align for word in words],
        "text_color": [word.color for word in words],
    }
    return columns, _leaders(words, obstacles)


def _words_of_loads(picture: Picture, obstacles: Obstacles) -> list[Word]:
    """Symbols and values of the loads."""
    layout = picture.layout
    words = []
    rows = 0
    for arrows, count in zip(picture.arrows, layout.equals, strict=True):
        act = arrows.act
        # Pressures from both sides have one text, and so have equal loads.
        if _is_repeated(act, picture.description.acts) or count == 0:
            continue
        word = _word_of_load(picture, arrows, count)
        if layout.angle or layout.is_told_above(act, count):
            above = layout.canvas.height - (rows + 0.5) * layout.row
            anchor = np.array([layout.origin[0], above])
            word = word._replace(anchor=anchor, align="center")
            rows += 1
        elif act.side == "body" and len(arrows.lines):
            word = _beside(word, picture.page(arrows.lines[0]), obstacles)
        words.append(word)
    return words


def _word_of_load(picture: Picture, arrows: Arrows, count: int) -> Word:
    """Symbol and value of a load, or of a number of equal ones, at its arrows."""
    act = arrows.act
    layout = picture.layout
    text = text_of(act, picture.now)
    anchor, align = anchor_of(arrows, layout)
    if count > 1:
        text += EACH
        if act.side in ("left", "right"):
            anchor = np.array([0.0, -FOOTING - 0.6 * layout.row])
            align = "center"
    return Word(text, picture.page(anchor), align, color_of(act))


def _is_repeated(act: Act, acts: Sequence[Act]) -> bool:
    """Check whether a load is a pressure from below that has its label above."""
    if not act.where.startswith("bottom"):
        return False
    above = [other for other in acts if other.where.startswith("top")]
    return any(is_opposite(act, other) for other in above)


def _beside(word: Word, line: Array, obstacles: Obstacles) -> Word:
    """A label next to an upright arrow, (n, 2), px, or below, if there is room.

    Below an arch, say, there is room at the arrow itself. An arrow on bodies ends
    at the ground, where there is none.
    """
    middle = line.mean(axis=0)
    if obstacles.has_bodies_below(word._replace(text="", anchor=middle)):
        return word
    foot = line[line[:, 1].argmin()]
    aside = np.array([12.0, 0.0])
    below = np.array([0.0, -8.0 - obstacles.layout.row])
    places = [
        word._replace(anchor=middle + aside, align="left"),
        word._replace(anchor=middle - aside, align="right"),
        word._replace(anchor=foot + below, align="center"),
    ]
    free = [place for place in places if not obstacles.covered_by(place)]
    return next(iter(free), word)


def _leaders(words: Sequence[Word], obstacles: Obstacles) -> Columns:
    """Leader lines from labels of a weight to the tails of its distant arrows.

    None where the line would lie on other words or arrows.
    """
    columns: Columns = {"xs": [], "ys": []}
    for word in words:
        line = _leader(word, obstacles)
        others = [other for other in words if other is not word]
        if len(line) and not _is_cut(line, others, obstacles):
            columns["xs"].append(line[:, 0].tolist())
            columns["ys"].append(line[:, 1].tolist())
    return columns


def _leader(word: Word, obstacles: Obstacles) -> Array:
    """Line from words of a weight to the tail of its arrow, (2, 2), px.

    It has no points where other words are given, or the arrow is near.
    """
    layout = obstacles.layout
    arrow = obstacles.weights.get(word.text)
    if arrow is not None:
        # From the points of the words that are nearest to those of the arrow.
        nearest = np.clip(arrow, *box_of(layout, word))
        if np.hypot(*(arrow - nearest).T).min() >= FAR * layout.row:
            begin = nearest[0]
            tail = arrow[0]
            if begin[1] != tail[1]:
                # On a page that is saved words are narrower: they keep their anchor.
                begin[0] = word.anchor[0]
            return np.stack([begin, tail])
    return np.zeros((0, 2))


def _is_cut(line: Array, others: Sequence[Word], obstacles: Obstacles) -> bool:
    """Check whether other words or handles lie on a line, (2, 2), px, or (0, 2)."""
    if not len(line):
        return False
    shares = np.linspace(0.1, 0.9, ALONG)[:, None]
    return obstacles.block(line[0] + shares * (line[1] - line[0]), others)


def _slope(picture: Picture) -> Word:
    """Label of the angle of tilted bodies, at the horizontal below their foot."""
    layout = picture.layout
    side = 1.0
    align = "left"
    if picture.tilt < 0.0:
        side = -1.0
        align = "right"
    text = f"slope {number(float(np.degrees(picture.tilt)))}°"
    _, end = picture.horizontal
    # Lower than the ground, which ends beside it where it hardly tilts.
    anchor = picture.page(end) + np.array([8.0 * side, -0.5 * layout.row])
    return Word(text, anchor, align, FORCE)


def _name_of_ground(picture: Picture) -> list[Word]:
    """Label of the ground of a case, if any."""
    surroundings = picture.layout.canvas.surroundings
    if surroundings is None:
        return []
    edge = ground_edge(picture.layout, picture.factor)
    end = edge[0] + [8.0, -0.5 * GROUND]
    align = "left"
    if picture.layout.angle:
        end = edge[-1] - [10.0, 0.5 * GROUND]
        align = "center"
    return [Word(surroundings.ground, picture.page(end), align, GROUND_COLOR)]


def _name_of_joint(picture: Picture, obstacles: Obstacles) -> list[Word]:
    """Label of the selected joint of bodies of any shape, if there is room.

    Titles of plots name the joint, too: on bodies it would hide what it names.
    """
    layout = picture.layout
    line = picture.halo
    # Where bodies are small the name would cover them.
    room = NAMED * layout.size[0] * layout.scale[0]
    if layout.letter * len(picture.selected) > room:
        return []
    if not picture.is_of_any_shape or not len(line):
        return []
    places = []
    for name in _names_at_ends(picture, line):
        # Beside a joint that ends within bodies the next row may be free.
        places += [name, *in_rows(layout, name, 1)]
    places += _names_aside(picture, line)
    # Below the ground of a case, say.
    for name in _names_at_ends(picture, line):
        places += in_rows(layout, name, MOST_ROWS)
    free = [place for place in places if not obstacles.covered_by(place)]
    return free[:1]


def _names_at_ends(picture: Picture, line: Array) -> list[Word]:
    """Labels of a joint beyond both ends of its line, (n, 2), px.

    The end that is nearer to the middle of all bodies comes first.
    """
    middle = 0.5 * picture.layout.size * picture.layout.scale * [0.0, 1.0]
    ends = line[[0, -1]]
    nearer = int(np.hypot(*(ends - middle).T).argmin())
    names = []
    for end in (nearer, 1 - nearer):
        away = ends[end] - ends[1 - end]
        away /= np.hypot(*away) or 1.0
        align = "center"
        if abs(away[0]) > ASKEW:
            align = "left" if away[0] > 0.0 else "right"
        anchor = picture.page(ends[end] + NAME * away)
        names.append(Word(picture.selected, anchor, align, REFERENCE))
    return names


def _names_aside(picture: Picture, line: Array) -> list[Word]:
    """The name of a joint aside of each end of its line, (n, 2), px: of one in a notch.

    It stands in the row of that end, or in the next one.
    """
    layout = picture.layout
    names = []
    for end in picture.page(line[[0, -1]]):
        for rows in (0, 1, -1):
            for side, align in ((1, "left"), (-1, "right")):
                anchor = np.add(end, [side * NAME, rows * layout.row])
                name = Word(picture.selected, anchor, align, REFERENCE)
                if is_inside(layout, name):
                    names.append(name)
    return names


def _apart(words: Sequence[Word], obstacles: Obstacles) -> list[Word]:
    """Labels, moved up, down or aside, off earlier ones, arrows, bodies and ground.

    They go to the next place that is free, and from which a line may lead to an arrow
    that is far; where there is none, arrows come before bodies.
    """
    layout = obstacles.layout
    placed: list[Word] = []
    for index, word in enumerate(words):
        others = [*placed, *words[index + 1 :]]

        def burden(place: Word, others: Sequence[Word] = others) -> tuple[bool, ...]:
            return (
                obstacles.has_arrows_below(place),
                obstacles.has_bodies_below(place),
                obstacles.has_ground_below(place),
                _is_cut(_leader(place, obstacles), others, obstacles),
            )

        chosen = word
        if meets(layout, word, placed) or any(burden(word)):
            places = [word, *around(layout, word, MOST_ROWS)]
            free = [one for one in places if not meets(layout, one, placed)]
            # Without a place that is free of all, the one with the least burden.
            unburdened = (one for one in free if not any(burden(one)))
            chosen = next(unburdened, None) or min(free, key=burden, default=word)
        placed.append(chosen)
    return placed
