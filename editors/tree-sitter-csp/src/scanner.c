// A duration is a number and a unit of time on one line (`2 s`, `100ns`), unless the unit is the beginning of a longer word
// (`2 safe`). It is one token, as in grammars/csp.lark.

#include "tree_sitter/parser.h"

enum TokenType { DURATION };

static bool is_digit(int32_t character) { return character >= '0' && character <= '9'; }

static bool is_letter(int32_t character) {
  return (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
}

static bool is_white_space(int32_t character) {
  return character == ' ' || character == '\t' || character == '\r' || character == '\n' || character == '\f';
}

static void advance(TSLexer *lexer) { lexer->advance(lexer, false); }

// One or more digits.
static bool scan_digits(TSLexer *lexer) {
  if (!is_digit(lexer->lookahead)) return false;
  while (is_digit(lexer->lookahead)) advance(lexer);
  return true;
}

static bool scan_number(TSLexer *lexer) {
  if (!scan_digits(lexer)) return false;
  if (lexer->lookahead == '.') {
    advance(lexer);
    if (!scan_digits(lexer)) return false;
  }
  if (lexer->lookahead == 'e' || lexer->lookahead == 'E') {
    advance(lexer);
    if (lexer->lookahead == '+' || lexer->lookahead == '-') advance(lexer);
    if (!scan_digits(lexer)) return false;
  }
  return true;
}

static bool same_text(const char *left, const char *right) {
  while (*left != '\0' && *left == *right) {
    left++;
    right++;
  }
  return *left == *right;
}

// A whole word that is a unit of time or of frequency.
static bool scan_unit(TSLexer *lexer) {
  static const char *const UNITS[] = {"ns", "us", "ms", "s", "min", "Hz", "kHz", "MHz"};
  char word[4] = {0};
  unsigned length = 0;
  while (is_letter(lexer->lookahead)) {
    if (length == sizeof word - 1) return false;
    word[length++] = (char)lexer->lookahead;
    advance(lexer);
  }
  if (is_digit(lexer->lookahead) || lexer->lookahead == '_') return false;
  for (unsigned i = 0; i < sizeof UNITS / sizeof UNITS[0]; i++) {
    if (same_text(word, UNITS[i])) return true;
  }
  return false;
}

void *tree_sitter_csp_external_scanner_create(void) { return NULL; }

void tree_sitter_csp_external_scanner_destroy(void *payload) { (void)payload; }

unsigned tree_sitter_csp_external_scanner_serialize(void *payload, char *buffer) {
  (void)payload;
  (void)buffer;
  return 0;
}

void tree_sitter_csp_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
  (void)payload;
  (void)buffer;
  (void)length;
}

bool tree_sitter_csp_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid_symbols) {
  (void)payload;
  if (!valid_symbols[DURATION]) return false;
  while (is_white_space(lexer->lookahead)) lexer->advance(lexer, true);
  if (!scan_number(lexer)) return false;
  while (lexer->lookahead == ' ' || lexer->lookahead == '\t') advance(lexer);
  if (!scan_unit(lexer)) return false;
  lexer->mark_end(lexer);
  lexer->result_symbol = DURATION;
  return true;
}
