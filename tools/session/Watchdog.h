#pragma once

namespace lamella::cli
{

/// Of a process that the one of the session made: ends it soon after a signal, as the session's own, without a word.
void watchProcess() noexcept;

} // namespace lamella::cli
