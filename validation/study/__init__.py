"""Error against run time, side by side with Mitsuba: writes the study folder that `tyndall report` makes a page of."""
