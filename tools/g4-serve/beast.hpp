// SPDX-License-Identifier: MIT
// Boost.Beast as this server uses it, for web_server.cpp alone: no executor is type-erased, because that doubles the
// time to compile.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream_fwd.hpp>
#include <chrono>

namespace g4_tool {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

using error_code = beast::error_code;
using executor = asio::io_context::executor_type;
using tcp_stream = beast::basic_stream<asio::ip::tcp, executor, beast::unlimited_rate_policy>;
using deadline = asio::basic_waitable_timer<std::chrono::steady_clock,
                                            asio::wait_traits<std::chrono::steady_clock>, executor>;
using http_request = http::request<http::empty_body>;

}  // namespace g4_tool
