# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators have in common that work on the occurrences of the selected curves."""

from __future__ import annotations

from ..fcn_addon import selection


class OnOccurrence:
    """Needs a selected curve of an occurrence, in object mode; says so where there is none."""

    @classmethod
    def poll(cls, context):
        why = "Leave the edit mode first" if context.mode != "OBJECT" else None
        if why is None and not any(map(selection.is_of_occurrence, context.selected_objects)):
            why = "Select a curve of an occurrence"
        if why:
            cls.poll_message_set(why)
        return not why
