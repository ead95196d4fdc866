# SPDX-License-Identifier: GPL-3.0-or-later
"""Goes on with all views between two events of the window, as long as any has something to do."""

import bpy

from .. import fault
from ..export.base.report import escaped
from ..handlers import registration

_views = []


def add(view):
    _views.append(view)


def wake():
    """Something has changed."""
    if not bpy.app.timers.is_registered(_step):
        bpy.app.timers.register(_step, first_interval=0.0)


def close_all(*_):
    """Before the file goes, or the add-on: nothing of ours may run on."""
    while _views:
        _views.pop().close()
    if bpy.app.timers.is_registered(_step):
        bpy.app.timers.unregister(_step)


def views():
    """Those that are still there."""
    return [view for view in _views if view.is_alive]


def view_of(area):
    """The view that an area shows, of four the one that was drawn last; or None."""
    regions = {region.as_pointer() for region in area.regions}
    found = [view for view in views() if view.region in regions]
    return max(found, key=lambda view: view.looked, default=None)


def _step():
    delays = []
    for view in list(_views):
        if not view.is_alive:
            _views.remove(view)
            view.close()
            continue
        try:
            delays.append(view.step())
        except Exception as error:  # a view that fails may not stop the others, nor the window
            view.fail(escaped(fault.traced(error)))
    delays = [delay for delay in delays if delay is not None]
    return min(delays) if delays else None


def _forget(*_):
    """An undo may put other things where some were."""
    for view in views():
        view.forget()
        wake()


register, _remove_handlers = registration(
    ("load_pre", close_all), ("undo_post", _forget), ("redo_post", _forget)
)


def unregister():
    _remove_handlers()
    close_all()
