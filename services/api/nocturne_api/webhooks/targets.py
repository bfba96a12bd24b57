"""Where webhooks may lead: to public addresses, whatever their names say.

A name is looked up once for each attempt, all its addresses are checked, and one of those is connected to: a
name that means another address a moment later (DNS rebinding) gains nothing.
"""

import asyncio
import ipaddress
import socket
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from urllib.parse import urlsplit

from nocturne_scene.errors import InputError

Network = ipaddress.IPv4Network | ipaddress.IPv6Network
Address = ipaddress.IPv4Address | ipaddress.IPv6Address
Resolve = Callable[[str, int], Awaitable[Sequence[str]]]

_MAX_CHARACTERS = 2048
_PLACE = "$.url"
# IPv4 inside IPv6, for translators that some networks have (RFC 6052, RFC 8215).
_TRANSLATED = (ipaddress.ip_network("64:ff9b::/96"), ipaddress.ip_network("64:ff9b:1::/48"))


class TargetRefused(Exception):
    """The address is not one that a webhook may lead to; `str()` says why."""


@dataclass(frozen=True)
class Target:
    """A webhook's address taken apart."""

    url: str
    scheme: str
    host: str
    port: int


async def look_up(host: str, port: int) -> Sequence[str]:
    """All addresses of a name, by the system's resolver."""
    found = await asyncio.get_running_loop().getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return [str(address[0]) for *_, address in found]


class TargetRules:
    """Allowed addresses: https to public addresses; both schemes to `networks`, for receivers at home."""

    def __init__(self, networks: Sequence[Network] = (), resolve: Resolve = look_up) -> None:
        self._networks = networks
        self._resolve = resolve

    def parse(self, url: str) -> Target:
        """Raises InputError for text that can't be an address. Says nothing of where it leads."""
        if len(url) > _MAX_CHARACTERS or not url.isascii() or not url.isprintable() or " " in url:
            raise InputError.at(_PLACE, f"expected at most {_MAX_CHARACTERS} printable ASCII characters")
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise InputError.at(_PLACE, f"is no address: {error}") from None
        schemes = ("https", "http") if self._networks else ("https",)
        if parts.scheme not in schemes or not parts.hostname:
            raise InputError.at(_PLACE, f"expected {' or '.join(schemes)}://HOST/...")
        if parts.username is not None or parts.password is not None or parts.fragment:
            raise InputError.at(_PLACE, "may have no user, password or fragment: messages are signed instead")
        if port == 0:
            raise InputError.at(_PLACE, "port 0 is no port")
        return Target(url, parts.scheme, parts.hostname, port or (443 if parts.scheme == "https" else 80))

    def admit(self, url: str) -> None:
        """Raises InputError where `parse` does, and for a number that is no allowed address: what a name
        means is known only when it is asked."""
        target = self.parse(url)
        if not _is_literal(target.host):
            return
        try:
            self._check(ipaddress.ip_address(target.host), target)
        except TargetRefused as refused:
            raise InputError.at(_PLACE, str(refused)) from None

    async def address(self, target: Target) -> str:
        """The address to connect to, now. Raises TargetRefused if any of the name's may not be asked."""
        try:
            found = (
                [target.host] if _is_literal(target.host) else await self._resolve(target.host, target.port)
            )
        except (OSError, UnicodeError):
            raise TargetRefused(f"the name {target.host} is not known") from None
        addresses = [ipaddress.ip_address(each) for each in found]
        if not addresses:
            raise TargetRefused(f"the name {target.host} has no address")
        for address in addresses:
            self._check(address, target)
        return str(addresses[0])

    def _check(self, address: Address, target: Target) -> None:
        if any(address.version == network.version and address in network for network in self._networks):
            return
        if not _is_public(address):
            raise TargetRefused(f"{target.host} is not a public address")
        if target.scheme != "https":
            raise TargetRefused(f"{target.host} is public, where only https is used")


def _is_literal(host: str) -> bool:
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def _is_public(address: Address) -> bool:
    if isinstance(address, ipaddress.IPv6Address) and (
        address.ipv4_mapped is not None
        or address.sixtofour is not None
        or address.teredo is not None
        or address.scope_id is not None
        or any(address in network for network in _TRANSLATED)
    ):
        return False
    return address.is_global and not address.is_multicast and not address.is_reserved
