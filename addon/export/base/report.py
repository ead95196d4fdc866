# SPDX-License-Identifier: GPL-3.0-or-later
"""What export has to say to the artist: named, deduplicated, in the order in which it was met.

A problem that the frame survives is an entry of the `Report`.  One that it does not survive is an
`ExportError`.  Nothing is dropped without one or the other.
"""

import unicodedata


def counted(count, one, many=None):
    """ "1 face", "2 faces": `many` is the plural where it takes more than an s."""
    return f"{count} {one if count == 1 else many or one + 's'}"


class ExportError(Exception):
    """The frame cannot be rendered.  The text names the datablock: "scene 'Scene': no camera"."""

    def __init__(self, datablock, message):
        super().__init__(f"{datablock}: {message}")
        self.datablock = datablock
        self.message = message


class Cancelled(Exception):
    """The user ended the render while the scene was being read."""


def poll(check_cancel, wanted=0):
    """Raises Cancelled, or what check_cancel raises, when the user has cancelled.

    `wanted`: bytes that are about to be taken, where these are many.
    """
    if check_cancel(wanted):
        raise Cancelled


class Report:
    """Recoverable problems.  Calling it is the same as `warn`, so it serves as a plain callback."""

    def __init__(self):
        self._counts = {}

    def warn(self, datablock, message):
        """Notes one problem.

        Args:
            datablock: kind and name, "mesh 'Cube'".
            message: what is wrong and what happens instead, without the name.
        """
        key = (datablock, message)
        self._counts[key] = self._counts.get(key, 0) + 1

    __call__ = warn

    def entries(self):
        """[(datablock, message, times met)], each pair once."""
        return [(datablock, message, count) for (datablock, message), count in self._counts.items()]

    def __len__(self):
        return len(self._counts)


def overheard(report):
    """(said, note): what `note` is called with goes on to `report`, and stands in the list `said`."""
    said = []

    def note(datablock, message):
        said.append((datablock, message))
        report(datablock, message)

    return said, note


def escaped(text):
    """Text that does nothing to a terminal and stays on its line: control characters, line separators,
    marks that turn the direction of writing and halves of surrogate pairs are shown as Python writes them."""
    return "".join(
        character if _is_plain(character) else repr(character)[1:-1] for character in text
    )


def _is_plain(character):
    # Other format characters (Cf) hold emoji together.
    return unicodedata.category(character) not in _CONTROLS and character not in _DIRECTIONS


_CONTROLS = {"Cc", "Cs", "Zl", "Zp"}
_DIRECTIONS = set("\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")

NAMED = 3  # datablocks that one line names


def lines(entries):
    """One line for each message, however many datablocks it is about.

    Args:
        entries: [(datablock, message, times met)].

    Returns:
        ["mesh 'A', mesh 'B', mesh 'C' and 23 more: is empty"], in the order in which the messages
        first come; fit to be shown (`escaped`).
    """
    about = {}
    for datablock, message, count in entries:
        about.setdefault(message, []).append((datablock, count))
    found = []
    for message, met in about.items():
        names = ", ".join(datablock for datablock, _ in met[:NAMED])
        more = f" and {len(met) - NAMED} more" if len(met) > NAMED else ""
        times = sum(count for _, count in met)
        repeated = f" ({times} times)" if times > len(met) else ""
        found.append(escaped(f"{names}{more}: {message}{repeated}"))
    return found
