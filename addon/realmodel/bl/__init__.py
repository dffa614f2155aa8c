# SPDX-License-Identifier: GPL-3.0-or-later
"""The only place where arrays meet bpy. Each folder says what comes in and what goes out, and imports from
those above it in docs/dev/architecture.md; `changes` is what follows when a setting changes."""
