# SPDX-License-Identifier: BSD-3-Clause
"""A word becomes a category of models: meaning, words, sources, judgement, library (doc/acquisition.md)."""
