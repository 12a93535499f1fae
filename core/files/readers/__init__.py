# SPDX-License-Identifier: GPL-3.0-or-later
"""A module for each format that is read; `core.files.formats` says which takes which file."""
