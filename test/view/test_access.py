# SPDX-License-Identifier: Apache-2.0
"""Who may open the page."""

import http
import types

import pytest

from rigid_body_sim.view.access import COOKIE, Access


@pytest.mark.parametrize(('headers', 'allowed'), [
    ({'Host': '127.0.0.1:8080'}, True), ({'Host': 'localhost:8080'}, True),
    ({'Host': '[::1]:8080'}, True), ({'Host': 'evil.example:8080'}, False), ({}, False),
    ({'Host': 'localhost:8080', 'Origin': 'http://localhost:8080'}, True),
    ({'Host': 'localhost:8080', 'Origin': 'https://evil.example'}, False),
    ({'Host': 'localhost:8080', 'Origin': 'http://localhost:9999'}, False),
    ({'Host': 'localhost:8080', 'Origin': 'null'}, False)])
def test_locally_only_pages_that_came_from_here_get_through(headers, allowed):
    assert Access().allows('/', headers) == allowed
    assert Access().address(8080) == 'http://127.0.0.1:8080/'


def test_on_another_host_only_who_has_the_token_gets_through():
    access = Access('192.0.2.7')
    headers = {'Host': '192.0.2.7:8080'}
    path = access.address(8080).removeprefix('http://192.0.2.7:8080')
    assert access.allows(path, headers)
    assert access.allows('/', {**headers, 'Cookie': f'{COOKIE}={access.token}'})
    assert not access.allows('/', headers)
    assert not access.allows('/?token=guess', headers)
    assert not access.allows('/', {**headers, 'Cookie': f'{COOKIE}=guess'})
    assert not access.allows(path, {**headers, 'Origin': 'https://evil.example'})
    assert access.token != Access('192.0.2.7').token
    assert len(access.token) == 22    # 16 bytes


def answer(access, path, response, host='192.0.2.7:8080'):
    """Return what a browser gets that viser would answer so."""
    connection = types.SimpleNamespace(respond=lambda status, text: status)
    request = types.SimpleNamespace(path=path, headers={'Host': host})
    return access._answer(lambda connection, request: response, connection, request)


def test_who_is_refused_gets_no_page_and_the_token_becomes_a_cookie():
    access = Access('192.0.2.7')
    page, later = (types.SimpleNamespace(headers={}) for _ in range(2))
    assert answer(access, '/', page) is http.HTTPStatus.FORBIDDEN
    assert answer(access, f'/?token={access.token}', page) is page
    assert page.headers == {
        'Set-Cookie': f'{COOKIE}={access.token}; HttpOnly; SameSite=Strict; Path=/'}
    # a socket has no page
    assert answer(access, f'/?token={access.token}', None) is None
    assert answer(Access(), '/?token=any', later, 'localhost:8080') is later
    assert later.headers == {}
