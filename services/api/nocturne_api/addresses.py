"""Addresses that the endpoints may listen on: this machine only, unless another is asked for explicitly."""

import ipaddress
import socket


class AddressError(Exception):
    """The address can't be used; `str()` says why and what to do."""


def check_host(host: str, any_address: bool) -> bool:
    """Whether `host` is loopback; raises AddressError where it is not and that was not asked for."""
    if _is_loopback(host):
        return True
    if not any_address:
        raise AddressError(
            f"{host} can be reached by others: without authentication, or without TLS, anyone who gets "
            "there can run renders, read images and fill the disk. Use --host 127.0.0.1 with an SSH tunnel; "
            "or --auth with --tls-certificate and --tls-key; or, inside a private network only, "
            "--insecure-any-address."
        )
    return False


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def listen(host: str, port: int) -> socket.socket:
    """A listening TCP socket; port 0 takes a free one. Raises AddressError where the port is taken."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    # Its connections inherit the option. Without it, a body waits 40 ms for the caller to acknowledge the
    # head.
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    try:
        listener.bind((host, port))
        listener.listen(128)
    except OSError as error:
        listener.close()
        raise AddressError(
            f"can't listen on {host}:{port}: {error.strerror}. Choose another port."
        ) from error
    return listener
