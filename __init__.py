# SPDX-License-Identifier: GPL-3.0-or-later
"""Feature Curve Co-Completion, a Blender extension."""


def register():
    from .fcn_addon import registration

    registration.register()


def unregister():
    from .fcn_addon import registration

    registration.unregister()
