"""The solar wind: pressure over time, the laws it is drawn from, and measured series."""
