"""Runs the spindle until the emergency button is pressed: whatever the law is doing is
abandoned and the brake is applied. That it halted is announced when it stands still.
"""
