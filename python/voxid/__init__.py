# SPDX-License-Identifier: BSD-3-Clause
"""What of voxid is written in Python: acquisition of models."""
