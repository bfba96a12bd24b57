"""Seeing a render elsewhere than on the page: in a terminal that shows images, and in a running tev."""
