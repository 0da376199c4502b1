"""Reactive driving: goal controllers, protective zones, assistance for a person at the joystick."""
