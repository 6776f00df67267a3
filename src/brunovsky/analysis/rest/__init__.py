"""From rest to rest: resting poses at random, and what becomes of them under poles in the frame of the goal."""
