"""The stability table (level 5 of how a result is believed): extremes of every number that a scene gives, each against truth.

One file for each group of rows; `case.py` is what they share, `judge.py` decides, `report.py` tells.
"""
