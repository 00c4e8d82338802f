"""Is this machine fit to render? Checks that take less than two minutes, and a report to attach to a bug."""
