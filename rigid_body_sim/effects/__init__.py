"""Effects: anything but the constraint that acts on a body, one file each."""

EFFECTS = {}
