# SPDX-License-Identifier: MIT OR Apache-2.0
"""An open benchmark of deep contact: two closed surfaces that overlap, and what libraries make of them.

Library is the interface to write for a library of your own; `python -m penetration_benchmark --help` runs it.
"""

from .library import Contacts, Library

__all__ = ["Contacts", "Library"]
