# SPDX-License-Identifier: Apache-2.0
"""Access to the page: from this machine; if another host is named, for whoever has the token.

Any web page in a browser of this machine can reach a local port. So a request must name the host
that it was served from: requests of a foreign page (header Origin) and under a foreign name
(header Host) are refused. On another interface the address contains a random token, which the
first answer stores as a cookie.
"""

import contextlib
import functools
import hmac
import http
import http.cookies
import ipaddress
import secrets
import urllib.parse

LOCAL = '127.0.0.1'
COOKIE = 'rigid_body_sim_view'


class Access:
    """The rule of one server.

    Parameters
    ----------
    host : str
        Address to listen on.
    """

    def __init__(self, host=LOCAL):
        self.host = host
        self.token = None if _is_local(host) else secrets.token_urlsafe(16)

    def address(self, port):
        """Return the address of the page, with the token."""
        name = f'[{self.host}]' if ':' in self.host else self.host
        return f'http://{name}:{port}/' + (f'?token={self.token}' if self.token else '')

    def allows(self, path, headers):
        """Return whether a request may pass, by its path and its headers."""
        host, origin = headers.get('Host', ''), headers.get('Origin')
        if origin is not None and urllib.parse.urlsplit(origin).netloc != host:
            return False
        if self.token is None:
            return _is_local(urllib.parse.urlsplit(f'//{host}').hostname or '')
        return any(hmac.compare_digest(one.encode(), self.token.encode())
                   for one in (_token_of(path), _cookie_of(headers)) if one)

    @contextlib.contextmanager
    def guarding(self):
        """Make a server that viser starts inside this context ask :meth:`allows` first."""
        from websockets.asyncio import server
        plain = server.serve

        @functools.wraps(plain)
        def serve(*arguments, process_request, **options):
            return plain(*arguments, process_request=functools.partial(self._answer,
                                                                       process_request), **options)

        server.serve = serve
        try:
            yield
        finally:
            server.serve = plain

    def _answer(self, answer, connection, request):
        if not self.allows(request.path, request.headers):
            return connection.respond(http.HTTPStatus.FORBIDDEN,
                                      'open the address that the shell printed\n')
        response = answer(connection, request)
        if response is not None and self.token and _token_of(request.path):
            response.headers['Set-Cookie'] = (f'{COOKIE}={self.token}; HttpOnly; SameSite=Strict; '
                                              'Path=/')
        return response


def _is_local(name):
    with contextlib.suppress(ValueError):
        return ipaddress.ip_address(name).is_loopback
    return name == 'localhost'


def _token_of(path):
    return urllib.parse.parse_qs(urllib.parse.urlsplit(path).query).get('token', [''])[0]


def _cookie_of(headers):
    cookies = http.cookies.SimpleCookie(headers.get('Cookie', ''))
    return cookies[COOKIE].value if COOKIE in cookies else ''
