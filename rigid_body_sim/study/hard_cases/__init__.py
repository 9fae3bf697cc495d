"""Hard cases: on which general simulators lose energy, blow up, refuse or lie; one table for the command and for test/hard_cases."""
