"""Speed figures as ratios measured in one run; see README.md."""
