# SPDX-License-Identifier: MIT OR Apache-2.0
"""Elastic bodies, each library in its own solver: `python -m penetration_benchmark.deforming --help`."""
