/* SPDX-License-Identifier: MIT */
/**
 * @file
 * The doctor: examines a lidar, its connection and its port, or a file, in stages. The stages are data:
 * verdicts, diagnoses with cause and advice, and what was measured. (docs/design/doctor.md)
 */
#ifndef G4LIDAR_C_DOCTOR_H
#define G4LIDAR_C_DOCTOR_H

#include "g4lidar/c/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** How a stage ended, the worst last. */
enum g4lidar_verdict {
  G4LIDAR_VERDICT_OK = 0,      /**< No fault. */
  G4LIDAR_VERDICT_SKIPPED = 1, /**< It could not be examined. */
  G4LIDAR_VERDICT_WARN = 2,    /**< A fault that a program may live with. */
  G4LIDAR_VERDICT_FAIL = 3     /**< A fault that must be repaired. */
};

/** What is wrong. The texts are valid forever. */
typedef struct g4lidar_diagnosis {
  const char* name;   /**< "wrong_baud_rate": for programs; it does not change. */
  const char* cause;  /**< The most likely cause: sentences. */
  const char* advice; /**< What to try: sentences. */
  int32_t severity;   /**< G4LIDAR_VERDICT_WARN or G4LIDAR_VERDICT_FAIL. */
  int32_t reserved;   /**< 0. */
} g4lidar_diagnosis;

/** The kinds of value of a measurement. */
enum g4lidar_value_kind {
  G4LIDAR_VALUE_INTEGER = 1, /**< `integer`. */
  G4LIDAR_VALUE_REAL = 2,    /**< `real`. */
  G4LIDAR_VALUE_TEXT = 3     /**< `text` only. */
};

/** One measurement or fact. */
typedef struct g4lidar_evidence {
  const char* name; /**< It ends in its unit: "slowest_ms". */
  const char* unit; /**< "ms", "s", "Hz", "%" or "baud"; empty for counts and texts. */
  const char* text; /**< The value for people, without its unit. */
  int64_t integer;  /**< The value, if it is an integer. */
  double real;      /**< The value, if it is a number. */
  int32_t kind;     /**< A g4lidar_value_kind. */
  int32_t reserved; /**< 0. */
} g4lidar_evidence;

/** How one stage ended. A view. */
typedef struct g4lidar_stage {
  const char* name;                   /**< "port", "baud_rate", "loss": it does not change. */
  const char* remark;                 /**< One more sentence; may be empty. */
  const g4lidar_diagnosis* diagnoses; /**< The most likely first. */
  size_t diagnosis_count;             /**< Their number. */
  const g4lidar_evidence* evidence;   /**< What was measured. */
  size_t evidence_count;              /**< Their number. */
  int32_t verdict;                    /**< A g4lidar_verdict. */
} g4lidar_stage;

/** How a lidar is examined. */
typedef struct g4lidar_doctor_options {
  size_t struct_size;        /**< Set by g4lidar_doctor_options_init(). */
  int64_t measuring_time_ns; /**< How long to measure the running scan; 5 s. */
  /** Called about 20 times a second; returning true ends the run. NULL: never. */
  bool (*is_cancelled)(void* context);
  /** Called with each stage when it ends; the view is valid during the call. NULL: not called. */
  void (*on_stage)(const g4lidar_stage* stage, void* context);
  void* context;       /**< Passed to both. They must not throw C++ exceptions. */
  uint32_t baud;       /**< Bits per second; 0: those of the model, or as they are found. */
  uint8_t reserved[4]; /**< 0. */
  /** The model that is expected: "x4"; NULL: the one that the device or the file shows. Copied. */
  const char* model;
} g4lidar_doctor_options;

/** Sets the defaults; `size` is sizeof(g4lidar_doctor_options). */
G4LIDAR_C_API void g4lidar_doctor_options_init(g4lidar_doctor_options* options, size_t size);

/** The stages of an examination. */
typedef struct g4lidar_report g4lidar_report;

/** Examines what `source` names, as in g4lidar_options; with "file:PATH" or the path of a recording a
 *  file. A fault of the lidar is not an error: it is in the report. Takes about 3 s plus the measuring
 *  time with a healthy lidar, 8 s if it has to be searched, and at most 45 s plus the measuring time with
 *  one fault. Sends queries, one start, and stops. `options` may be NULL. */
G4LIDAR_C_API int g4lidar_diagnose(const char* source, const g4lidar_doctor_options* options,
                                   g4lidar_report** report, g4lidar_error* error);
/** The same for a simulated lidar; in virtual time it takes no time. */
G4LIDAR_C_API int g4lidar_diagnose_simulated(g4lidar_simulator* simulator,
                                             const g4lidar_doctor_options* options,
                                             g4lidar_report** report, g4lidar_error* error);
/** The number of stages. */
G4LIDAR_C_API size_t g4lidar_report_count(const g4lidar_report* report);
/** Stage `index`; NULL if there are not as many. Valid as long as the report. */
G4LIDAR_C_API const g4lidar_stage* g4lidar_report_at(const g4lidar_report* report, size_t index);
/** Releases a report. */
G4LIDAR_C_API void g4lidar_report_free(g4lidar_report* report);

#ifdef __cplusplus
}
#endif

#endif
