"""Replaying single paths on the device, to see what each vertex did."""
